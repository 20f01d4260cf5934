// Searches that expand neighbours in the graph's own order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// The ways from one node outwards, nearest first: breadth first where every edge costs 1, else by Dijkstra's algorithm.
// Among equally near nodes the one met first comes first. Keeps its memory from one search to the next, and clears only
// what the last one touched.
class NearestFirst {
 public:
  explicit NearestFirst(const Graph& graph) : graph_(&graph), seen_(graph.node_count()), parent_(graph.node_count()) {}

  // Calls visit(node, cost) for every node that can be had for at most max_cost, but `from`, nearest first; goes on
  // from it where visit answers kThrough, stays out of it for good where kPast, ends everything at kEnd.
  enum class Next { kThrough, kPast, kEnd };
  template <typename Visit>
  void run(NodeId from, double max_cost, const Visit& visit);

  // The way to a node met in the last run: every node after its start, the node last.
  std::vector<NodeId> path_to(NodeId node) const {
    std::vector<NodeId> path;
    for (NodeId step = node; parent_[step] != step; step = parent_[step]) path.push_back(step);
    std::reverse(path.begin(), path.end());
    return path;
  }

 private:
  struct Reached {
    double cost;
    std::int64_t order;
    NodeId node;
    NodeId parent;
    bool operator>(const Reached& other) const { return cost != other.cost ? cost > other.cost : order > other.order; }
  };

  const Graph* graph_;
  std::vector<std::uint32_t> seen_;  // [N], the run that met it last
  std::vector<NodeId> parent_;       // [N]
  std::uint32_t run_ = 0;
  std::vector<Reached> queue_;  // breadth first: in order; Dijkstra: a heap
};

template <typename Visit>
void NearestFirst::run(NodeId from, double max_cost, const Visit& visit) {
  if (++run_ == 0) {
    std::fill(seen_.begin(), seen_.end(), 0);
    run_ = 1;
  }
  queue_.assign(1, {0, 0, from, from});
  std::int64_t met = 0;
  const bool heap = graph_->weighted();
  if (!heap) {
    seen_[from] = run_;
    parent_[from] = from;
  }
  for (std::size_t head = 0; head < queue_.size();) {
    Reached here = queue_[head];
    if (heap) {
      here = queue_.front();
      std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
      queue_.pop_back();
      if (seen_[here.node] == run_) continue;
      seen_[here.node] = run_;
      parent_[here.node] = here.parent;
    } else {
      ++head;
    }
    if (here.node != from) {
      const Next next = visit(here.node, here.cost);
      if (next == Next::kEnd) return;
      if (next == Next::kPast) continue;
    }
    const auto neighbours = graph_->neighbours(here.node);
    for (int i = 0; i < std::ssize(neighbours); ++i) {
      const NodeId next = neighbours[i];
      if (seen_[next] == run_) continue;
      const double cost = here.cost + graph_->cost(here.node, i);
      if (cost > max_cost) continue;
      queue_.push_back({cost, ++met, next, here.node});
      if (heap) {
        std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
      } else {
        seen_[next] = run_;
        parent_[next] = here.node;
      }
    }
  }
}

// The way to the nearest node that `is_goal` accepts, through nodes that `may_enter` accepts: every node after `from`,
// the goal last. Empty where there is none. Among equally near goals the one met first wins. Cost: O(nodes + edges),
// times a logarithm where edges have costs.
template <typename IsGoal, typename MayEnter>
std::vector<NodeId> path_to_nearest(const Graph& graph, NodeId from, const IsGoal& is_goal, const MayEnter& may_enter) {
  using Next = NearestFirst::Next;
  NearestFirst search(graph);
  NodeId goal = kNoNode;
  search.run(from, std::numeric_limits<double>::infinity(), [&](NodeId node, double) {
    if (!may_enter(node)) return Next::kPast;
    if (!is_goal(node)) return Next::kThrough;
    goal = node;
    return Next::kEnd;
  });
  return goal == kNoNode ? std::vector<NodeId>() : search.path_to(goal);
}

// How many connected components the nodes that are not blocked fall into, whichever way edges lead. REQUIRES: blocked
// has a value per node.
int count_components(const Graph& graph, const std::vector<bool>& blocked);

}  // namespace graphdrl
