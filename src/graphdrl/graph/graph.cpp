#include "graphdrl/graph/graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

Graph Graph::from_edges(NodeId node_count, std::span<const Edge> edges) {
  std::vector<std::vector<NodeId>> lists(node_count);
  for (const Edge& edge : edges) {
    for (const NodeId end : {edge.a, edge.b}) {
      if (end < 0 || end >= node_count) {
        throw Error({.what = "edge to a node that is not there",
                     .expected = fmt::format("node ids 0 to {}", node_count - 1),
                     .got = fmt::format("{}", end)});
      }
    }
    if (edge.a == edge.b) throw Error({.what = fmt::format("edge from node {} to itself", edge.a)});
    lists[edge.a].push_back(edge.b);
    lists[edge.b].push_back(edge.a);
  }
  Graph graph;
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbours_.insert(graph.neighbours_.end(), list.begin(), list.end());
    graph.offsets_.push_back(static_cast<std::int64_t>(graph.neighbours_.size()));
  }
  return graph;
}

Graph Graph::grid(int rows, int cols) {
  Graph graph;
  for (NodeId node = 0; node < rows * cols; ++node) {
    for (const Direction direction : kAllDirections) {
      const NodeId next = grid_neighbour(rows, cols, node, direction);
      if (next != kNoNode) graph.neighbours_.push_back(next);
    }
    graph.offsets_.push_back(static_cast<std::int64_t>(graph.neighbours_.size()));
  }
  return graph;
}

Graph Graph::without(const std::vector<bool>& dropped) const {
  Graph graph;
  for (NodeId node = 0; node < node_count(); ++node) {
    for (const NodeId next : neighbours(node)) {
      if (!dropped[node] && !dropped[next]) graph.neighbours_.push_back(next);
    }
    graph.offsets_.push_back(static_cast<std::int64_t>(graph.neighbours_.size()));
  }
  return graph;
}

}  // namespace graphdrl
