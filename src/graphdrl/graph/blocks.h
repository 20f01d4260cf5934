// Biconnected blocks and strongly connected components of the part of a graph that can be reached from a node.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// The blocks of a graph, whichever way edges lead, seen from a root node. Two nodes share a block where no single node
// parts them; a block hangs from the one of its nodes that is nearest to the root.
class Blocks {
 public:
  // into: the graph turned round. in_reach: [N], the nodes to look at, the root among them and connected to it.
  // Depth-first search [Hopcroft and Tarjan 1973]. Cost: O(nodes + edges).
  Blocks(const Graph& graph, const Graph& into, NodeId root, const std::vector<bool>& in_reach);

  // A block comes after all blocks that hang from its members.
  int count() const { return static_cast<int>(roots_.size()); }
  NodeId root(int block) const { return roots_[block]; }
  std::span<const NodeId> members(int block) const {  // without the root
    return {members_.data() + offsets_[block], members_.data() + offsets_[block + 1]};
  }
  std::int64_t first_member(int block) const { return offsets_[block]; }  // its place among those of all blocks

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
