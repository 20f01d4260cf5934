// Graphs as other languages hand them over: arrays.
#pragma once

#include "graphdrl/env/world.h"

namespace graphdrl {

// Of N nodes and E edges. What is empty is not there: costs and prizes are 1 then, and nothing is blocked.
struct GraphArrays {
  std::string name;
  std::int64_t node_count = 0;
  std::span<const std::int64_t> edges = {};  // [2E], pairs of nodes; loops are left out
  std::span<const double> costs = {};        // [E], of parallel edges the lowest counts
  bool directed = false;
  std::vector<bool> blocked = {};        // [N]
  std::vector<std::string> labels = {};  // [N]
  std::vector<double> prizes = {};       // [N]
  Places places = {};                    // [N]
  GivenTask given = {};
};

// Throws Error on lengths that do not fit, nodes that there are not, and numbers that cannot be.
World world_of(GraphArrays arrays);

}  // namespace graphdrl
