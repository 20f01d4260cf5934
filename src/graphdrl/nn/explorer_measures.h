// What the explorer's features say, measured on the horizon. Every function overwrites its result, the last argument,
// and reuses the memory in it. Lists marked [H] are by local index [horizon.h]; costs are in mean edges of the world.
#pragma once

#include <cstdint>
#include <vector>

#include "graphdrl/nn/horizon.h"

namespace graphdrl {

// Where fewer than kLeastVisits first visits are in scope, the scope grows to up to twice its size.
inline constexpr int kLeastVisits = 3;

// What can be reached with what is left to spend.
struct Nearby {
  std::vector<double> distance;       // [H] from the current node, through any ground; kNoLimit where not measured
  std::vector<int> nearest;           // local indices, nearest first, the current node first; twice the scope at most
  std::vector<std::uint8_t> is_near;  // [H] flags of `nearest`
  bool nearest_are_all = false;       // nothing else is in reach
  double work = 0;                    // unvisited nodes in reach; those beyond the horizon are taken to be
};
void measure_nearby(const Exploration& state, const Horizon& horizon, int scope, NearestFirst& search, Nearby& nearby);

struct FirstVisits {
  std::vector<FirstVisit> all;  // nearest first
  std::vector<double> cost;     // [H] of the first visit; kNoLimit of nodes without one
  bool left_out = false;        // there may be more

  bool lead_to(int index) const { return cost[index] < kNoLimit; }
};
// Finds all that a scope may hold, and at least kLeastVisits. Stops after kExplorerHorizon searched nodes once it has
// one.
void find_first_visits(const Exploration& state, const Horizon& horizon, const Nearby& nearby, NearestFirst& search,
                       FirstVisits& visits);

// The nodes that the network looks at.
struct Scope {
  std::vector<int> nodes;    // local indices, in the order of rows
  std::vector<int> row;      // [H], -1 out of scope
  double share_of_work = 1;  // in scope, of the work in reach

  bool holds(int index) const { return index >= 0 && row[index] >= 0; }
};
// Takes the nearest nodes in reach, up to `size`; more of them, or far first visits, until kLeastVisits are in scope.
void choose_scope(const View& view, const Horizon& horizon, const Nearby& nearby, const FirstVisits& visits, int size,
                  Scope& scope);

// steps: [H], to the nearest unvisited node; -1 where none is known.
void measure_steps_to_work(const Horizon& horizon, std::vector<int>& queue, std::vector<int>& steps);

// Parts: unvisited nodes connected through unvisited ones. A part that goes on beyond the horizon has all
// `unvisited_beyond` of them. size: [H], of the node's part; 0 of visited nodes and of parts out of scope.
void measure_parts(const Horizon& horizon, const Scope& scope, int unvisited_beyond, std::vector<int>& queue,
                   std::vector<int>& size);

// Unvisited nodes that can be left only by the way one came. Visited ground next to a node holds it as one more edge
// would, and so do nodes beyond the horizon.
struct HangingTrees {
  std::vector<std::uint8_t> hanging;  // [H], flags
  std::vector<int> size;              // [H] nodes of the tree from here outwards, or of those that hang on the node
  std::vector<int> height;            // [H] steps to the farthest of them
  std::vector<int> ties;              // [H] scratch memory: what still holds the node
};
void measure_hanging_trees(const Horizon& horizon, std::vector<int>& queue, HangingTrees& trees);

}  // namespace graphdrl
