// Breadth-first searches that expand neighbours in the graph's own order.
#pragma once

#include <algorithm>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// The way to the nearest node that `is_goal` accepts, through nodes that `may_enter` accepts: every node after `from`,
// the goal last. Empty where there is none. Among equally near goals the one met first wins. Cost: O(nodes + edges).
template <typename IsGoal, typename MayEnter>
std::vector<NodeId> path_to_nearest(const Graph& graph, NodeId from, const IsGoal& is_goal, const MayEnter& may_enter) {
  std::vector<NodeId> parent(graph.node_count(), kNoNode);
  std::vector<NodeId> queue = {from};
  parent[from] = from;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const NodeId node = queue[head];
    for (const NodeId next : graph.neighbours(node)) {
      if (parent[next] != kNoNode || !may_enter(next)) continue;
      parent[next] = node;
      if (is_goal(next)) {
        std::vector<NodeId> path;
        for (NodeId step = next; step != from; step = parent[step]) path.push_back(step);
        std::reverse(path.begin(), path.end());
        return path;
      }
      queue.push_back(next);
    }
  }
  return {};
}

// How many connected components the nodes that are not blocked fall into. REQUIRES: blocked has a value per node.
int count_components(const Graph& graph, const std::vector<bool>& blocked);

}  // namespace graphdrl
