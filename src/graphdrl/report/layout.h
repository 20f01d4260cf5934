// Where to draw the nodes of a graph.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/env/world.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// Places whose distances are near those in the graph, in edges of either direction, rounded to thousandths. Stochastic
// gradient descent lowers the stress [Zheng, Pawar and Goodman 2018]: over all pairs of a small graph; in a large one
// over its edges and the distances from a few nodes far apart. The same graph is always drawn the same way. Cost:
// O(pairs), at most about 3 million, or O(edges).
std::vector<Point> lay_out(const Graph& graph);

// The nodes' own places; those of lay_out() in a world without coordinates.
std::vector<Point> places_of(const World& world);

// Around points, however many.
struct Box {
  double left = kNoLimit, bottom = kNoLimit, right = -kNoLimit, top = -kNoLimit;
};
Box box_of(std::span<const Point> points);

}  // namespace graphdrl
