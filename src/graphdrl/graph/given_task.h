// What a file says of the walk asked for, where it does.
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
