// The frontier of an exploration, in parts, and a tour of them.
#pragma once

#include <vector>

#include "graphdrl/env/exploration.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// First visits next to each other, or next to the same node of the ground.
struct FrontierPart {
  FirstVisit nearest;
  int size = 0;  // first visits
};

// All parts that can be reached, nearest first. A part reaches at most most_steps from its nearest first visit; what
// lies beyond is another part. The search has then met all first visits. Cost: all ground in reach.
std::vector<FrontierPart> frontier_parts(const Exploration& now, NearestFirst& search, int most_steps);

// The first visit with which a short tour of the frontier begins, which ends where the walk must; kNoNode where there
// is none. The search has then met it. Parts are cut at 24 steps; those of fewer first visits than smallest_part wait
// until there are no others.
//
// The way between two parts is not looked for. It is taken to cost what the cheapest ways to both cost beyond where
// they fork, as if edges led both ways; where nodes have places, the mean of that and of a straight way.
NodeId first_stop_of_frontier_tour(const Exploration& now, NearestFirst& search, int smallest_part);

}  // namespace graphdrl
