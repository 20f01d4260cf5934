#include "graphdrl/graph/search.h"

namespace graphdrl {

std::vector<double> costs_to(const Graph& into, NodeId goal) {
  std::vector<double> costs(into.node_count(), kNoLimit);
  costs[goal] = 0;
  NearestFirst().run_cheapest(into, goal, kNoLimit, [&](NodeId node, double cost) {
    costs[node] = cost;
    return NearestFirst::Next::kThrough;
  });
  return costs;
}

}  // namespace graphdrl
