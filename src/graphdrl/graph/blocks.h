// Biconnected blocks and strongly connected components of the part of a graph that can be reached from a node.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// The blocks of a graph, seen from a root node; directions of edges do not count. Two nodes share a block if no single
// other node parts them. A block hangs from its node nearest to the root.
class Blocks {
 public:
  // into: the graph with its edges turned round. in_reach: [N], the nodes to look at, all connected to the root, which
  // is one of them.
  // Depth-first search [Hopcroft and Tarjan 1973]. Cost: O(nodes + edges).
  Blocks(const Graph& graph, const Graph& into, NodeId root, const std::vector<bool>& in_reach);

  // A block comes after all blocks that hang from its members.
  int count() const { return static_cast<int>(roots_.size()); }
  NodeId root(int block) const { return roots_[block]; }
  std::span<const NodeId> members(int block) const {  // without the root
    return {members_.data() + offsets_[block], members_.data() + offsets_[block + 1]};
  }
  std::int64_t first_member(int block) const { return offsets_[block]; }  // its index among the members of all blocks

 private:
  std::vector<NodeId> roots_;
  std::vector<std::int64_t> offsets_ = {0};
  std::vector<NodeId> members_;
};

// The strongly connected component of each node that can be reached from `root` through nodes in reach, by Kosaraju's
// algorithm; -1 for others. Components are numbered so that edges lead to higher numbers only.
std::vector<int> strong_components(const Graph& graph, const Graph& into, NodeId root,
                                   const std::vector<bool>& in_reach);

}  // namespace graphdrl
