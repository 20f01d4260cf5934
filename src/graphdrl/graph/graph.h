// Graphs in compressed sparse row form, and the grid graphs of the paper.
#pragma once

#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace graphdrl {

struct GridMap;

using NodeId = std::int32_t;
inline constexpr NodeId kNoNode = -1;

// Undirected, or from a to b in a directed graph.
struct Edge {
  NodeId a;
  NodeId b;
  double cost = 1;
};

enum class EdgeKind { kUndirected, kDirected };

// Costs between all pairs of nodes, computed when they are asked for: symmetric, finite, not negative. Immutable: any
// number of threads may ask.
class PairCosts {
 public:
  virtual ~PairCosts() = default;
  virtual double cost(NodeId from, NodeId to) const = 0;
  // Whether no way through other nodes is cheaper than the straight one. Distances that are rounded to the nearest
  // number are not metric.
  virtual bool metric() const { return false; }
};

// A graph without loops or parallel edges; nodes are 0 … node_count() - 1. Any number of threads may read one that does
// not grow. The order of a node's neighbours is part of the graph: searches and ties follow it.
class Graph {
 public:
  Graph() = default;
  // Without nodes, to grow.
  explicit Graph(EdgeKind kind) : kind_(kind) {}

  // Neighbours in ascending order. Leaves out loops, since a walk never gains by them. Of parallel edges the cheapest
  // stays. Throws Error on an edge out of range and on a cost that is negative or not finite. Cost: linear but for
  // sorting each node's neighbours. REQUIRES: node_count >= 0.
  static Graph from_edges(NodeId node_count, std::span<const Edge> edges, EdgeKind kind = EdgeKind::kUndirected);

  // The edges between free cells of a map: nodes in row-major order, neighbours in that of kGridSteps.
  static Graph grid(const GridMap& map);
  // The same without obstacles and diagonals. REQUIRES: rows * cols fits a NodeId.
  static Graph grid(int rows, int cols);

  // An undirected edge between any two nodes. A node's neighbours are in ascending order: first those after the node,
  // then those before it. Memory: O(nodes), and what the costs need. Cost: a look at every pair. If costs are not
  // metric, a way through other nodes may be cheaper than the straight one [NearestFirst::run_cheapest()].
  // progress: told how much is done, 0 to 1.
  static Graph complete(NodeId node_count, std::shared_ptr<const PairCosts> costs,
                        const std::function<void(double share)>& progress = {});
  bool is_complete() const { return pair_costs_ != nullptr; }
  // Whether straight edges are the cheapest ways in a complete graph; true of other graphs.
  bool straight_ways_suffice() const { return !is_complete() || pair_costs_->metric(); }

  // The same nodes without the edges of dropped ones. REQUIRES: dropped has a value per node.
  Graph without(const std::vector<bool>& dropped) const;

  // Undirected, every edge of cost 1. offsets: [N + 1], where each node's neighbours begin, and the end. REQUIRES: each
  // edge stands once in the list of each of its two nodes.
  static Graph from_lists(std::vector<std::int64_t> offsets, std::vector<NodeId> neighbours);

  // Grows by a node without edges; gives its id.
  NodeId add_node();
  // Grows by an edge that is not there yet. It stands before the first neighbour with a greater id, or at the given
  // place of a node's list: lists of more than eight must stay in ascending order. Cost: O(degrees), amortised.
  // REQUIRES: the graph is not complete; both nodes are there and differ; the cost is finite and not negative.
  struct Places {
    int of_b = -1;  // in the list of a
    int of_a = -1;  // in the list of b, if the graph is undirected
  };
  void add_edge(const Edge& edge, const Places& places);
  void add_edge(const Edge& edge) { add_edge(edge, Places()); }
  // Loses an edge that is there. Costs of others may from then on lie within closer bounds than min_cost() and
  // max_cost(). Cost: O(degrees). REQUIRES: the graph is not complete.
  void remove_edge(NodeId from, NodeId to);

  // The same graph with every edge turned round. An undirected graph stays as it is.
  Graph reversed() const;

  NodeId node_count() const { return static_cast<NodeId>(lists_.size()); }
  std::int64_t edge_count() const { return directed() ? arc_count_ : arc_count_ / 2; }
  bool directed() const { return kind_ == EdgeKind::kDirected; }
  bool weighted() const { return !costs_.empty() || is_complete(); }  // some edge costs other than 1

  // Where edges lead from a node, and how many there are.
  std::span<const NodeId> neighbours(NodeId node) const {
    return {neighbours_.data() + lists_[node].begin, static_cast<std::size_t>(lists_[node].size)};
  }
  int degree(NodeId node) const { return lists_[node].size; }

  // The cost of going to neighbours(node)[i].
  double cost(NodeId node, int index) const {
    if (is_complete()) return pair_costs_->cost(node, neighbours_[lists_[node].begin + index]);
    return costs_.empty() ? 1.0 : costs_[lists_[node].begin + index];
  }

  // The index of `next` in neighbours(node), or -1. Cost: O(log degree), or O(8) on a grid.
  int index_of(NodeId node, NodeId next) const;

  // Of the costs of all edges, computed beforehand. 1 without edges; the mean is 1 if all edges cost 0.
  double min_cost() const { return min_cost_; }
  double max_cost() const { return max_cost_; }
  double mean_cost() const { return mean_cost_; }

  // Every cost is a whole number, and their sum, an undirected edge counted twice, is below 2^53: sums of costs are
  // exact, in any order.
  bool integer_costs() const { return integer_costs_; }

  // Every edge, an undirected one from its lower node.
  std::vector<Edge> edges() const;

 private:
  // Where a node's neighbours stand.
  struct List {
    std::int64_t begin;
    std::int32_t size;
    std::int32_t room;  // for so many, before the list must move
  };
  // What is known of some costs. Sums run in the order in which they are added.
  struct CostSum {
    static CostSum of(double cost);
    void add(const CostSum& more);

    double sum = 0;
    double least = std::numeric_limits<double>::infinity();
    double most = 0;
    bool integers = true;
  };

  // Goes on with the next node, after the neighbours of this one, and their costs if edges have costs, were added.
  void close_node();
  void insert_arc(NodeId from, NodeId to, double cost, int place);
  double erase_arc(NodeId from, NodeId to);  // gives its cost
  // Forgets costs that are all 1, else computes what is known of them.
  void settle_costs();
  void settle_costs(const CostSum& all);

  EdgeKind kind_ = EdgeKind::kUndirected;
  std::vector<List> lists_;         // [N]; of a complete graph each reaches far into the next
  std::vector<NodeId> neighbours_;  // [2E], or [E] of a directed graph; [2N] of a complete one; more if it grew
  std::int64_t arc_count_ = 0;      // edges, undirected ones twice
  std::shared_ptr<const PairCosts> pair_costs_;  // of a complete graph
  std::vector<double> costs_;                    // as neighbours_; empty where every edge costs 1
  double cost_sum_ = 0;                          // of arcs, where edges have costs
  double min_cost_ = 1;
  double max_cost_ = 1;
  double mean_cost_ = 1;
  bool integer_costs_ = true;
};

}  // namespace graphdrl
