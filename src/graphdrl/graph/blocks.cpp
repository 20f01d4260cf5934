#include "graphdrl/graph/blocks.h"

#include <algorithm>

namespace graphdrl {
namespace {

// The neighbours of a node in both directions: where edges lead to, then where they come from.
class BothWays {
 public:
  BothWays(const Graph& graph, const Graph& into) : graph_(graph), into_(into) {}
  std::size_t count(NodeId node) const {
    return graph_.neighbours(node).size() + (graph_.directed() ? into_.neighbours(node).size() : 0);
  }
  NodeId at(NodeId node, std::size_t place) const {
    const auto out = graph_.neighbours(node);
    return place < out.size() ? out[place] : into_.neighbours(node)[place - out.size()];
  }

 private:
  const Graph& graph_;
  const Graph& into_;
};

}  // namespace

Blocks::Blocks(const Graph& graph, const Graph& into, NodeId root, const std::vector<bool>& in_reach) {
  struct Frame {
    NodeId node;
    NodeId parent;
    std::size_t next = 0;  // index among its neighbours
  };
  const BothWays neighbours(graph, into);
  std::vector<int> depth(graph.node_count(), -1);
  std::vector<int> low(graph.node_count());
  std::vector<NodeId> open;  // nodes of blocks not closed yet
  std::vector<Frame> stack = {{root, kNoNode}};
  int clock = 0;
  depth[root] = low[root] = clock++;
  while (!stack.empty()) {
    Frame& frame = stack.back();
    const NodeId node = frame.node;
    if (frame.next < neighbours.count(node)) {
      const NodeId next = neighbours.at(node, frame.next++);
      if (!in_reach[next] || next == frame.parent) continue;
      if (depth[next] >= 0) {
        low[node] = std::min(low[node], depth[next]);
        continue;
      }
      depth[next] = low[next] = clock++;
      open.push_back(next);
      stack.push_back({next, node});
      continue;
    }
    const NodeId parent = frame.parent;
    stack.pop_back();
    if (parent == kNoNode) break;
    low[parent] = std::min(low[parent], low[node]);
    if (low[node] < depth[parent]) continue;
    roots_.push_back(parent);
    do {
      members_.push_back(open.back());
      open.pop_back();
    } while (members_.back() != node);
    offsets_.push_back(std::ssize(members_));
  }
}

std::vector<int> strong_components(const Graph& graph, const Graph& into, NodeId root,
                                   const std::vector<bool>& in_reach) {
  struct Frame {
    NodeId node;
    std::size_t next = 0;
  };
  std::vector<bool> seen(graph.node_count());
  std::vector<NodeId> finished;  // by the time the search leaves them
  std::vector<Frame> stack = {{root}};
  seen[root] = true;
  while (!stack.empty()) {
    Frame& frame = stack.back();
    const auto neighbours = graph.neighbours(frame.node);
    if (frame.next == neighbours.size()) {
      finished.push_back(frame.node);
      stack.pop_back();
      continue;
    }
    const NodeId next = neighbours[frame.next++];
    if (seen[next] || !in_reach[next]) continue;
    seen[next] = true;
    stack.push_back({next});
  }
  std::vector<int> component(graph.node_count(), -1);
  int count = 0;
  std::vector<NodeId> members;
  for (auto last = finished.rbegin(); last != finished.rend(); ++last) {
    if (component[*last] >= 0) continue;
    members.assign(1, *last);
    component[*last] = count;
    while (!members.empty()) {
      const NodeId node = members.back();
      members.pop_back();
      for (const NodeId from : into.neighbours(node)) {
        if (!seen[from] || component[from] >= 0) continue;
        component[from] = count;
        members.push_back(from);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace graphdrl
