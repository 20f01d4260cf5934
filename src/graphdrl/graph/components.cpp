#include "graphdrl/graph/components.h"

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <numeric>

namespace graphdrl {
namespace {

// Sets of nodes, each node its own at first.
class NodeSets {
 public:
  explicit NodeSets(std::size_t nodes) : rank_(nodes), parent_(nodes) {
    std::iota(parent_.begin(), parent_.end(), NodeId{0});
  }

  void unite(NodeId one, NodeId other) { sets_.union_set(one, other); }

  // Numbers the sets of the nodes that are not blocked, in the order of their lowest nodes.
  Components numbered(const std::vector<bool>& blocked) {
    Components result;
    result.of.assign(parent_.size(), Components::kNone);
    std::vector<int> index(parent_.size(), Components::kNone);  // by a set's representative
    for (NodeId node = 0; node < std::ssize(parent_); ++node) {
      if (blocked[node]) continue;
      int& component = index[sets_.find_set(node)];
      if (component == Components::kNone) {
        component = result.count();
        result.sizes.push_back(0);
      }
      result.of[node] = component;
      ++result.sizes[component];
    }
    return result;
  }

 private:
  std::vector<unsigned char> rank_;  // at most log2 of the nodes
  std::vector<NodeId> parent_;
  boost::disjoint_sets<unsigned char*, NodeId*, boost::find_with_path_halving> sets_{rank_.data(), parent_.data()};
};

}  // namespace

int Components::largest() const {
  if (sizes.empty()) return kNone;
  return static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

Components find_components(const Graph& graph, const std::vector<bool>& blocked) {
  NodeSets sets(blocked.size());
  NodeId last = kNoNode;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    if (blocked[node]) continue;
    if (graph.is_complete()) {
      if (last != kNoNode) sets.unite(last, node);
      last = node;
      continue;
    }
    for (const NodeId next : graph.neighbours(node)) {
      if (!blocked[next] && (graph.directed() || node < next)) sets.unite(node, next);
    }
  }
  return sets.numbered(blocked);
}

Components find_components(const GridMap& map) {
  NodeSets sets(map.blocked.size());
  for (NodeId node = 0; node < std::ssize(map.blocked); ++node) {
    if (map.blocked[node]) continue;
    for (const Direction direction : {Direction::kRight, Direction::kDown}) {
      const NodeId next = grid_neighbour(map.rows, map.cols, node, direction);
      if (next != kNoNode && !map.blocked[next]) sets.unite(node, next);
    }
  }
  return sets.numbered(map.blocked);
}

int count_components(const Graph& graph, const std::vector<bool>& blocked) {
  return find_components(graph, blocked).count();
}

}  // namespace graphdrl
