// Connected components of graphs, biconnected blocks and strongly connected components.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

struct Components {
  static constexpr int kNone = -1;

  std::vector<int> of;        // [N], the component of a node; kNone if it is blocked
  std::vector<NodeId> sizes;  // nodes of each component; components stand in the order of their lowest nodes

  int count() const { return static_cast<int>(sizes.size()); }
  int largest() const;  // the first among equals; kNone if there are none
};

// The connected components of the nodes that are not blocked; directions of edges do not count. Cost: as good as
// linear. REQUIRES: blocked has a value per node.
Components find_components(const Graph& graph, const std::vector<bool>& blocked);

// The components of a map's free cells.
Components find_components(const GridMap& map);

// The blocks of a graph, seen from a root node; directions of edges do not count. Two nodes share a block if no single
// other node parts them. A block hangs from its node nearest to the root.
class Blocks {
 public:
  // both_ways: the graph with every edge leading both ways. in_reach: [N], the nodes to look at, all connected to the
  // root, which is one of them.
  // Depth-first search [Hopcroft and Tarjan 1973]. Cost: O(nodes + edges).
  Blocks(const Graph& both_ways, NodeId root, const std::vector<bool>& in_reach);

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

// The strongly connected component of each node that can be reached from `root` through nodes in reach; -1 for others.
// Components are numbered so that edges lead to higher numbers only. Cost: O(nodes + edges).
std::vector<int> strong_components(const Graph& graph, NodeId root, const std::vector<bool>& in_reach);

}  // namespace graphdrl
