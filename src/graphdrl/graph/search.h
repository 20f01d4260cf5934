// Searches that expand neighbours in the graph's own order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// The ways from one node outwards, nearest first: breadth first if every edge costs 1, else by Dijkstra's algorithm; in
// a complete graph straight edges only. Of equally near nodes the one met first comes first.
//
// Scratch memory of one thread, for one search after the other, of any graphs. A search costs what it touches; only
// growing to the size of the graph, once, costs more.
class NearestFirst {
 public:
  // Calls visit(node, cost) for every node but `from` within max_cost, nearest first. The answer decides: kThrough goes
  // on from that node, kPast does not, kEnd ends the search.
  enum class Next { kThrough, kPast, kEnd };
  template <typename Visit>
  void run(const Graph& graph, NodeId from, double max_cost, const Visit& visit) {
    begin(graph.node_count());
    if (graph.is_complete()) {
      run_straight(graph, from, max_cost, visit);
    } else if (graph.weighted()) {
      run_dijkstra(graph, from, max_cost, visit);
    } else {
      run_breadth_first(graph, from, max_cost, visit);
    }
  }

  // The same, but in a complete graph by the cheapest ways; run() takes straight edges only.
  // Cost: O(N^2) there, unless costs are metric.
  template <typename Visit>
  void run_cheapest(const Graph& graph, NodeId from, double max_cost, const Visit& visit) {
    if (graph.straight_ways_suffice()) return run(graph, from, max_cost, visit);
    begin(graph.node_count());
    run_dense(graph, from, max_cost, visit);
  }

  // Appends the way to a node met in the last run: every node after the start, up to that node.
  void append_path_to(NodeId node, std::vector<NodeId>& walk) const {
    const auto first = std::ssize(walk);
    for (NodeId step = node; marks_[step].parent != step; step = marks_[step].parent) walk.push_back(step);
    std::reverse(walk.begin() + first, walk.end());
  }

 private:
  struct Mark {
    std::uint32_t run = 0;  // the run that met the node last
    NodeId parent = kNoNode;
  };
  struct Queued {
    std::uint32_t run = 0;  // the run that put the node into the heap last
    double cost = 0;        // and for what
  };
  struct Reached {
    double cost;
    std::int64_t order;
    NodeId node;
    NodeId parent;
    bool operator>(const Reached& other) const { return cost != other.cost ? cost > other.cost : order > other.order; }
  };

  void begin(NodeId node_count) {
    if (marks_.size() < static_cast<std::size_t>(node_count)) marks_.resize(node_count);
    if (++run_ == 0) {
      std::fill(marks_.begin(), marks_.end(), Mark());
      std::fill(queued_.begin(), queued_.end(), Queued());
      run_ = 1;
    }
  }
  bool met(NodeId node) const { return marks_[node].run == run_; }

  template <typename Visit>
  void run_breadth_first(const Graph& graph, NodeId from, double max_cost, const Visit& visit) {
    if (queue_.size() < marks_.size()) queue_.resize(marks_.size());
    NodeId* const queue = queue_.data();
    Mark* const marks = marks_.data();
    const std::uint32_t run = run_;
    queue[0] = from;
    marks[from] = {run, from};
    std::size_t head = 0;
    std::size_t size = 1;
    for (double cost = 0; head < size; cost += 1) {
      // Nodes of one distance stand together. Visiting them all meets those of the next distance.
      const bool last = cost + 1 > max_cost;
      for (const std::size_t end = size; head < end; ++head) {
        const NodeId here = queue[head];
        if (here != from) {
          const Next next = visit(here, cost);
          if (next == Next::kEnd) return;
          if (next == Next::kPast) continue;
        }
        if (last) continue;
        for (const NodeId next : graph.neighbours(here)) {
          if (marks[next].run == run) continue;
          marks[next] = {run, here};
          queue[size++] = next;
        }
      }
    }
  }

  template <typename Visit>
  void run_dijkstra(const Graph& graph, NodeId from, double max_cost, const Visit& visit) {
    if (queued_.size() < marks_.size()) queued_.resize(marks_.size());
    heap_.assign(1, {0, 0, from, from});
    std::int64_t order = 0;
    while (!heap_.empty()) {
      const Reached here = heap_.front();
      std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
      heap_.pop_back();
      if (met(here.node)) continue;
      marks_[here.node] = {run_, here.parent};
      if (here.node != from) {
        const Next next = visit(here.node, here.cost);
        if (next == Next::kEnd) return;
        if (next == Next::kPast) continue;
      }
      const auto neighbours = graph.neighbours(here.node);
      for (int i = 0; i < std::ssize(neighbours); ++i) {
        if (met(neighbours[i])) continue;
        const double cost = here.cost + graph.cost(here.node, i);
        if (cost > max_cost) continue;
        // Of a node only ever cheaper ways stand in the heap: any other would be met too late.
        Queued& queued = queued_[neighbours[i]];
        if (queued.run == run_ && queued.cost <= cost) continue;
        queued = {run_, cost};
        heap_.push_back({cost, ++order, neighbours[i], here.node});
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
      }
    }
  }

  template <typename Visit>
  void run_straight(const Graph& graph, NodeId from, double max_cost, const Visit& visit) {
    heap_.clear();
    const auto neighbours = graph.neighbours(from);
    for (int i = 0; i < std::ssize(neighbours); ++i) {
      const double cost = graph.cost(from, i);
      if (cost <= max_cost) heap_.push_back({cost, i, neighbours[i], from});
    }
    std::make_heap(heap_.begin(), heap_.end(), std::greater<>());
    marks_[from] = {run_, from};
    while (!heap_.empty()) {
      const Reached here = heap_.front();
      std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
      heap_.pop_back();
      marks_[here.node] = {run_, from};
      if (visit(here.node, here.cost) == Next::kEnd) return;
    }
  }

  // Dijkstra without a heap [1959].
  template <typename Visit>
  void run_dense(const Graph& graph, NodeId from, double max_cost, const Visit& visit) {
    heap_.clear();
    for (NodeId node = 0; node < graph.node_count(); ++node) {
      if (node != from) heap_.push_back({kNoLimit, node, node, from});
    }
    marks_[from] = {run_, from};
    NodeId here = from;
    double cost = 0;
    bool through = true;
    while (!heap_.empty()) {
      std::size_t nearest = 0;
      for (std::size_t i = 0; i < heap_.size(); ++i) {
        Reached& left = heap_[i];
        if (through) {
          const double there = cost + graph.cost(here, graph.index_of(here, left.node));
          if (there < left.cost) {
            left.cost = there;
            left.parent = here;
          }
        }
        if (heap_[nearest] > left) nearest = i;
      }
      const Reached met = heap_[nearest];
      if (met.cost > max_cost) return;
      heap_[nearest] = heap_.back();
      heap_.pop_back();
      here = met.node;
      cost = met.cost;
      marks_[here] = {run_, met.parent};
      const Next next = visit(here, cost);
      if (next == Next::kEnd) return;
      through = next == Next::kThrough;
    }
  }

  std::vector<Mark> marks_;  // [N]
  std::uint32_t run_ = 0;
  std::vector<NodeId> queue_;   // [N], breadth first: in order
  std::vector<Queued> queued_;  // [N], Dijkstra
  std::vector<Reached> heap_;   // Dijkstra; without a heap: what is not met yet
};

// The cost of the cheapest way from each node to `goal`; kNoLimit if there is no way. into: the graph with its edges
// turned round. Cost: as run_cheapest().
inline std::vector<double> costs_to(const Graph& into, NodeId goal) {
  std::vector<double> costs(into.node_count(), kNoLimit);
  costs[goal] = 0;
  NearestFirst().run_cheapest(into, goal, kNoLimit, [&](NodeId node, double cost) {
    costs[node] = cost;
    return NearestFirst::Next::kThrough;
  });
  return costs;
}

}  // namespace graphdrl
