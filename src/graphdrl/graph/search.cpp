#include "graphdrl/graph/search.h"

namespace graphdrl {

std::vector<double> costs_to(const Graph& into, NodeId goal) {
  std::vector<double> costs(into.node_count(), kNoLimit);
  costs[goal] = 0;
  NearestFirst().run(into, goal, kNoLimit, [&](NodeId node, double cost) {
    costs[node] = cost;
    return NearestFirst::Next::kThrough;
  });
  return costs;
}

int count_components(const Graph& graph, const std::vector<bool>& blocked) {
  const Graph back = graph.reversed();
  std::vector<bool> seen = blocked;
  int components = 0;
  std::vector<NodeId> stack;
  for (NodeId root = 0; root < graph.node_count(); ++root) {
    if (seen[root]) continue;
    ++components;
    seen[root] = true;
    stack.push_back(root);
    while (!stack.empty()) {
      const NodeId node = stack.back();
      stack.pop_back();
      for (const Graph* const edges : {&graph, &back}) {
        for (const NodeId next : edges->neighbours(node)) {
          if (seen[next]) continue;
          seen[next] = true;
          stack.push_back(next);
        }
      }
    }
  }
  return components;
}

}  // namespace graphdrl
