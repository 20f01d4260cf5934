#include "graphdrl/graph/components.h"

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <limits>
#include <numeric>

namespace graphdrl {
namespace {

// The components of the nodes that are not blocked. join_all(join): calls join(a, b) for edges between such nodes.
template <typename JoinAll>
Components components_of(const std::vector<bool>& blocked, const JoinAll& join_all) {
  std::vector<unsigned char> rank(blocked.size());  // at most log2 of the nodes
  std::vector<NodeId> parent(blocked.size());
  std::iota(parent.begin(), parent.end(), NodeId{0});
  boost::disjoint_sets<unsigned char*, NodeId*, boost::find_with_path_halving> sets(rank.data(), parent.data());
  join_all([&](NodeId one, NodeId other) { sets.union_set(one, other); });
  Components result;
  result.of.assign(blocked.size(), Components::kNone);
  std::vector<int> index(blocked.size(), Components::kNone);  // by a set's representative
  for (NodeId node = 0; node < std::ssize(blocked); ++node) {
    if (blocked[node]) continue;
    int& component = index[sets.find_set(node)];
    if (component == Components::kNone) {
      component = result.count();
      result.sizes.push_back(0);
    }
    result.of[node] = component;
    ++result.sizes[component];
  }
  return result;
}

// Tarjan's depth-first search [1972] from `root` through nodes in reach. order: [N], when each node was met; -1 before
// that. Calls leave(node, parent, low, open) after all edges of a node: low is the least order at their ends and below
// them; open has the nodes met and not taken out yet, the last one last.
template <typename Leave>
void search_depth_first(const Graph& graph, NodeId root, const std::vector<bool>& in_reach, std::vector<int>& order,
                        const Leave& leave) {
  struct Frame {
    NodeId node;
    NodeId parent;
    std::size_t next = 0;  // index among its neighbours
  };
  std::vector<int> low(order.size());
  std::vector<NodeId> open;
  std::vector<Frame> stack;
  int clock = 0;
  const auto enter = [&](NodeId node, NodeId parent) {
    order[node] = low[node] = clock++;
    open.push_back(node);
    stack.push_back({node, parent});
  };
  enter(root, kNoNode);
  while (!stack.empty()) {
    const auto [node, parent, index] = stack.back();
    const auto neighbours = graph.neighbours(node);
    if (index == neighbours.size()) {
      stack.pop_back();
      leave(node, parent, low[node], open);
      if (parent != kNoNode) low[parent] = std::min(low[parent], low[node]);
      continue;
    }
    ++stack.back().next;
    const NodeId next = neighbours[index];
    if (!in_reach[next]) continue;
    if (order[next] < 0) {
      enter(next, node);
    } else {
      low[node] = std::min(low[node], order[next]);
    }
  }
}

}  // namespace

int Components::largest() const {
  if (sizes.empty()) return kNone;
  return static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

Components find_components(const Graph& graph, const std::vector<bool>& blocked) {
  return components_of(blocked, [&](const auto& join) {
    NodeId last = kNoNode;
    for (NodeId node = 0; node < graph.node_count(); ++node) {
      if (blocked[node]) continue;
      if (graph.is_complete()) {
        if (last != kNoNode) join(last, node);
        last = node;
        continue;
      }
      for (const NodeId next : graph.neighbours(node)) {
        if (!blocked[next] && (graph.directed() || node < next)) join(node, next);
      }
    }
  });
}

Components find_components(const GridMap& map) {
  return components_of(map.blocked, [&](const auto& join) {
    for (NodeId node = 0; node < std::ssize(map.blocked); ++node) {
      if (map.blocked[node]) continue;
      const Cell at = map.cell(node);
      if (map.is_free({at.row, at.col + 1})) join(node, node + 1);
      if (map.is_free({at.row + 1, at.col})) join(node, node + map.cols);
    }
  });
}

Blocks::Blocks(const Graph& both_ways, NodeId root, const std::vector<bool>& in_reach) {
  std::vector<int> order(both_ways.node_count(), -1);
  search_depth_first(both_ways, root, in_reach, order, [&](NodeId node, NodeId parent, int low, auto& open) {
    if (parent == kNoNode || low < order[parent]) return;
    roots_.push_back(parent);
    do {
      members_.push_back(open.back());
      open.pop_back();
    } while (members_.back() != node);
    offsets_.push_back(std::ssize(members_));
  });
}

std::vector<int> strong_components(const Graph& graph, NodeId root, const std::vector<bool>& in_reach) {
  constexpr int kTaken = std::numeric_limits<int>::max();  // lowers nothing
  std::vector<int> order(graph.node_count(), -1);
  std::vector<int> component(graph.node_count(), -1);
  int count = 0;
  search_depth_first(graph, root, in_reach, order, [&](NodeId node, NodeId, int low, auto& open) {
    if (low < order[node]) return;
    for (NodeId member = kNoNode; member != node; open.pop_back()) {
      member = open.back();
      order[member] = kTaken;
      component[member] = count;
    }
    ++count;
  });
  // Where edges lead to is left first.
  for (int& number : component) number = number < 0 ? -1 : count - 1 - number;
  return component;
}

}  // namespace graphdrl
