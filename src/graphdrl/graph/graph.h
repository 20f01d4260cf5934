// Graphs in compressed sparse row form, and the grid graphs of the paper.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace graphdrl {

using NodeId = std::int32_t;
inline constexpr NodeId kNoNode = -1;

struct Edge {
  NodeId a;
  NodeId b;
};

// An undirected graph without loops or parallel edges; nodes are 0 … node_count() - 1. Immutable, so any number of
// threads may read it. The order of a node's neighbours is part of the graph: searches and ties follow it.
class Graph {
 public:
  Graph() = default;

  // Neighbours in ascending order. Throws Error on an edge out of range or from a node to itself; an edge given twice
  // counts once.
  static Graph from_edges(NodeId node_count, std::span<const Edge> edges);

  // Four-connected, nodes in row-major order, neighbours in the order left, up, right, down.
  // REQUIRES: rows * cols fits a NodeId.
  static Graph grid(int rows, int cols);

  // The same nodes, without the edges that touch a dropped one. REQUIRES: dropped has a value per node.
  Graph without(const std::vector<bool>& dropped) const;

  NodeId node_count() const { return static_cast<NodeId>(offsets_.size()) - 1; }
  std::int64_t edge_count() const { return static_cast<std::int64_t>(neighbours_.size()) / 2; }
  int degree(NodeId node) const { return static_cast<int>(offsets_[node + 1] - offsets_[node]); }
  std::span<const NodeId> neighbours(NodeId node) const {
    return {neighbours_.data() + offsets_[node], neighbours_.data() + offsets_[node + 1]};
  }

 private:
  std::vector<std::int64_t> offsets_ = {0};  // [N + 1]
  std::vector<NodeId> neighbours_;           // [2E]
};

}  // namespace graphdrl
