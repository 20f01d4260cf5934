// Graphs as other languages hand them over: arrays.
#pragma once

#include "graphdrl/env/world.h"

namespace graphdrl {

// Of N nodes and E edges.
struct EdgeArrays {
  std::int64_t node_count = 0;
  std::span<const std::int64_t> edges = {};  // [2E], pairs of nodes
  std::span<const double> costs = {};        // [E]; empty where each is 1
  bool directed = false;
};

// The world of these edges; `map` has all but the graph, and what is empty in it is not there. Throws Error on lengths
// that do not fit, nodes that there are not, and numbers that cannot be.
World world_of(std::string name, const EdgeArrays& arrays, GraphMap map);

}  // namespace graphdrl
