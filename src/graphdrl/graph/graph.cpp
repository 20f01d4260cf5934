#include "graphdrl/graph/graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {
namespace {

// Below this a double holds every whole number.
constexpr double kExactIntegers = 0x1p53;

// Throws Error on an edge out of range and on a bad cost.
void check_edges(NodeId node_count, std::span<const Edge> edges) {
  for (const Edge& edge : edges) {
    for (const NodeId end : {edge.a, edge.b}) {
      if (end < 0 || end >= node_count) {
        throw Error({.what = "edge to a node that is not there",
                     .expected = fmt::format("node ids 0 to {}", node_count - 1),
                     .got = fmt::format("{}", end)});
      }
    }
    if (!(edge.cost >= 0) || !std::isfinite(edge.cost)) {
      throw Error({.what = fmt::format("bad cost of the edge from {} to {}", edge.a, edge.b),
                   .expected = "a finite number from 0 up",
                   .got = fmt::format("{}", edge.cost)});
    }
  }
}

// One way along an edge.
struct Arc {
  NodeId to;
  double cost;
};

}  // namespace

// What is known of some costs. Sums run in the order of the edges.
struct Graph::CostSum {
  static CostSum of(double cost) { return {cost, cost, cost, cost == std::floor(cost)}; }
  void add(const CostSum& more) {
    sum += more.sum;
    least = std::min(least, more.least);
    most = std::max(most, more.most);
    integers = integers && more.integers;
  }

  double sum = 0;
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  bool integers = true;
};

Graph Graph::from_edges(NodeId node_count, std::span<const Edge> edges, EdgeKind kind) {
  check_edges(node_count, edges);
  const bool both_ways = kind == EdgeKind::kUndirected;
  std::vector<std::int64_t> ends(node_count);  // of each node's arcs, where those of the next one begin
  for (const Edge& edge : edges) {
    if (edge.a == edge.b) continue;
    ++ends[edge.a];
    if (both_ways) ++ends[edge.b];
  }
  std::exclusive_scan(ends.begin(), ends.end(), ends.begin(), std::int64_t{0});
  std::vector<Arc> arcs(edges.size() * (both_ways ? 2 : 1));
  for (const Edge& edge : edges) {
    if (edge.a == edge.b) continue;
    const double cost = edge.cost + 0.0;  // turns -0 into 0
    arcs[ends[edge.a]++] = {edge.b, cost};
    if (both_ways) arcs[ends[edge.b]++] = {edge.a, cost};
  }
  const bool unit_costs = std::all_of(edges.begin(), edges.end(), [](const Edge& edge) { return edge.cost == 1; });
  Graph graph;
  graph.kind_ = kind;
  graph.offsets_.reserve(static_cast<std::size_t>(node_count) + 1);
  graph.neighbours_.reserve(arcs.size());
  if (!unit_costs) graph.costs_.reserve(arcs.size());
  std::int64_t begin = 0;
  for (const std::int64_t end : ends) {
    const std::span<Arc> list(arcs.data() + begin, arcs.data() + end);
    std::sort(list.begin(), list.end(), [](const Arc& one, const Arc& other) {
      return one.to != other.to ? one.to < other.to : one.cost < other.cost;
    });
    NodeId last = kNoNode;
    for (const Arc& arc : list) {
      if (arc.to == last) continue;  // a parallel edge that is no cheaper
      last = arc.to;
      graph.neighbours_.push_back(arc.to);
      if (!unit_costs) graph.costs_.push_back(arc.cost);
    }
    graph.close_node();
    begin = end;
  }
  graph.settle_costs();
  return graph;
}

Graph Graph::grid(int rows, int cols) {
  return grid({.rows = rows, .cols = cols, .blocked = std::vector<bool>(static_cast<std::size_t>(rows) * cols)});
}

Graph Graph::grid(const GridMap& map) {
  Graph graph;
  graph.offsets_.reserve(map.blocked.size() + 1);
  for (NodeId node = 0; node < map.rows * map.cols; ++node) {
    const Cell at = map.cell(node);
    for (const Cell& step : map.steps()) {
      const Cell to = at + step;
      if (map.blocked[node] || !map.is_free(to)) continue;
      const bool diagonal = step.row != 0 && step.col != 0;
      const bool past_corner = diagonal && !(map.is_free({at.row, to.col}) && map.is_free({to.row, at.col}));
      if (past_corner && !map.cut_corners) continue;
      graph.neighbours_.push_back(map.node(to));
      if (map.diagonals) graph.costs_.push_back(diagonal ? std::numbers::sqrt2 : 1);
    }
    graph.close_node();
  }
  graph.settle_costs();
  return graph;
}

Graph Graph::complete(NodeId node_count, std::shared_ptr<const PairCosts> costs,
                      const std::function<void(double share)>& progress) {
  Graph graph;
  graph.offsets_.resize(static_cast<std::size_t>(node_count) + 1);
  std::iota(graph.offsets_.begin(), graph.offsets_.end(), std::int64_t{1});
  // All nodes twice, so that those after a node, and then those before it, stand together.
  for (int copy = 0; copy < 2; ++copy) {
    for (NodeId node = 0; node < node_count; ++node) graph.neighbours_.push_back(node);
  }
  graph.overlap_ = node_count - 2;
  graph.pair_costs_ = std::move(costs);
  if (node_count < 2) return graph;
  std::vector<CostSum> rows(node_count);  // from each node to those after it
  const auto fill = [&](NodeId node) {
    CostSum row;
    for (NodeId other = node + 1; other < node_count; ++other) {
      row.add(CostSum::of(graph.pair_costs_->cost(node, other)));
    }
    rows[node] = row;
  };
  constexpr NodeId kBatch = 256;  // of rows, after which progress is told
  for (NodeId begin = 0; begin < node_count; begin += kBatch) {
    parallel_for(std::min(kBatch, node_count - begin), [&](int i) { fill(begin + i); });
    const double left = 1 - static_cast<double>(std::min(begin + kBatch, node_count)) / node_count;
    if (progress) progress(1 - left * left);
  }
  CostSum all;
  for (const CostSum& row : rows) all.add(row);
  all.sum *= 2;  // both ways
  graph.settle_costs(all, 2 * graph.edge_count());
  return graph;
}

int Graph::index_of(NodeId node, NodeId next) const {
  if (is_complete()) {
    const NodeId index = next > node ? next - node - 1 : next - node - 1 + node_count();
    return next < 0 || next >= node_count() || next == node ? -1 : index;
  }
  const auto all = neighbours(node);
  // Lists longer than a grid's are in ascending order.
  const auto found = all.size() > kGridSteps.size() ? std::lower_bound(all.begin(), all.end(), next)
                                                    : std::find(all.begin(), all.end(), next);
  return found == all.end() || *found != next ? -1 : static_cast<int>(found - all.begin());
}

Graph Graph::without(const std::vector<bool>& dropped) const {
  if (is_complete()) {
    std::vector<Edge> left = edges();
    std::erase_if(left, [&](const Edge& edge) { return dropped[edge.a] || dropped[edge.b]; });
    return from_edges(node_count(), left);
  }
  Graph graph;
  graph.kind_ = kind_;
  graph.offsets_.reserve(offsets_.size());
  graph.neighbours_.reserve(neighbours_.size());
  graph.costs_.reserve(costs_.size());
  for (NodeId node = 0; node < node_count(); ++node) {
    for (std::int64_t i = offsets_[node]; i < offsets_[node + 1]; ++i) {
      if (dropped[node] || dropped[neighbours_[i]]) continue;
      graph.neighbours_.push_back(neighbours_[i]);
      if (weighted()) graph.costs_.push_back(costs_[i]);
    }
    graph.close_node();
  }
  graph.settle_costs();
  return graph;
}

Graph Graph::from_lists(std::vector<std::int64_t> offsets, std::vector<NodeId> neighbours) {
  Graph graph;
  graph.offsets_ = std::move(offsets);
  graph.neighbours_ = std::move(neighbours);
  return graph;
}

Graph Graph::reversed() const {
  if (!directed()) return *this;
  std::vector<Edge> turned = edges();
  for (Edge& edge : turned) std::swap(edge.a, edge.b);
  return from_edges(node_count(), turned, kind_);
}

std::vector<Edge> Graph::edges() const {
  std::vector<Edge> edges;
  edges.reserve(static_cast<std::size_t>(edge_count()));
  for (NodeId node = 0; node < node_count(); ++node) {
    for (int i = 0; i < degree(node); ++i) {
      const NodeId next = neighbours(node)[i];
      if (directed() || node < next) edges.push_back({node, next, cost(node, i)});
    }
  }
  return edges;
}

void Graph::settle_costs() {
  if (std::all_of(costs_.begin(), costs_.end(), [](double cost) { return cost == 1; })) {
    costs_ = {};
    return;
  }
  CostSum all;
  for (const double cost : costs_) all.add(CostSum::of(cost));
  settle_costs(all, std::ssize(costs_));
}

void Graph::settle_costs(const CostSum& all, std::int64_t count) {
  min_cost_ = all.least;
  max_cost_ = all.most;
  mean_cost_ = all.sum > 0 ? all.sum / static_cast<double>(count) : 1;
  integer_costs_ = all.integers && all.sum < kExactIntegers;
}

}  // namespace graphdrl
