// Nodes in paths and cycles: a 2-matching, each node next to two others where that can be.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/base/clock.h"
#include "graphdrl/graph/graph.h"

namespace graphdrl {

// Of some nodes of an undirected graph. An edge that costs more than the mean is none of these. Each node wants two
// links, the ends of a walk one. A node that wants more than it has is an end of a path.
class TwoMatching {
 public:
  // Two more edges, one after the other, between ends of paths that nothing else could join: they want no link more.
  struct Hop {
    NodeId from;
    NodeId over;  // is visited once more
    NodeId to;
  };

  TwoMatching(const Graph& graph, std::span<const NodeId> nodes);

  void end_at(NodeId node) { --wanted_[node]; }

  // Makes paths of the nodes, which have no links yet, in their order.
  void grow_paths();
  // Joins ends of paths along alternating paths, or by hops, until no two can be joined so or the clock passes.
  void join_ends(const Clock& clock = {});
  // Makes one of two parts wherever they run side by side and one of them is a cycle.
  void patch_cycles();

  // The nodes that one is linked to; kNoNode where it has fewer than two.
  const std::array<NodeId, 2>& links(NodeId node) const { return links_[node]; }
  int degree(NodeId node) const {
    return static_cast<int>(links_[node][0] != kNoNode) + static_cast<int>(links_[node][1] != kNoNode);
  }
  const std::vector<Hop>& hops() const { return hops_; }

 private:
  class EndSearch;

  bool is_end(NodeId node) const { return degree(node) < wanted_[node]; }
  bool linked(NodeId a, NodeId b) const { return links_[a][0] == b || links_[a][1] == b; }
  bool usable(NodeId from, int index) const {
    return covered_[graph_.neighbours(from)[index]] != 0 && graph_.cost(from, index) <= most_cost_;
  }
  void link(NodeId a, NodeId b);
  void unlink(NodeId a, NodeId b);

  const Graph& graph_;
  double most_cost_;  // of an edge
  std::vector<NodeId> nodes_;
  std::vector<char> covered_;                 // [N]
  std::vector<std::int8_t> wanted_;           // [N]
  std::vector<std::array<NodeId, 2>> links_;  // [N]
  std::vector<Hop> hops_;
};

}  // namespace graphdrl
