// Where to draw the nodes of a graph that has no coordinates.
#pragma once

#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/point.h"

namespace graphdrl {

// Places whose distances are near those in the graph, in edges whichever way they lead: stress lowered by stochastic
// gradient descent [Zheng, Pawar and Goodman 2018], over all pairs of a small graph; over edges and distances from a
// few nodes far apart of a large one. The same graph is drawn the same. Cost: O(pairs), at most about 3 million, or
// O(edges).
std::vector<Point> lay_out(const Graph& graph);

}  // namespace graphdrl
