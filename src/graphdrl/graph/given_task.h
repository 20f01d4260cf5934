// What a map file says of the walk: its budget, its start and its end, if it says any of them.
#pragma once

#include <optional>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

struct GivenTask {
  std::optional<double> budget;  // in units of cost
  NodeId start = kNoNode;
  NodeId end = kNoNode;
};

}  // namespace graphdrl
