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

Graph::CostSum Graph::CostSum::of(double cost) {
  return {cost, cost, cost, cost == std::floor(cost)};
}

void Graph::CostSum::add(const CostSum& more) {
  sum += more.sum;
  least = std::min(least, more.least);
  most = std::max(most, more.most);
  integers = integers && more.integers;
}

void Graph::close_node() {
  const auto size = static_cast<std::int32_t>(std::ssize(neighbours_) - arc_count_);
  lists_.push_back({.begin = arc_count_, .size = size, .room = size});
  arc_count_ += size;
}

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
  graph.lists_.reserve(node_count);
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
  graph.lists_.reserve(map.blocked.size());
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
  for (NodeId node = 0; node < node_count; ++node) graph.lists_.push_back({node + 1, node_count - 1, node_count - 1});
  // All nodes twice, so that those after a node, and then those before it, stand together.
  for (int copy = 0; copy < 2; ++copy) {
    for (NodeId node = 0; node < node_count; ++node) graph.neighbours_.push_back(node);
  }
  graph.arc_count_ = std::int64_t{node_count} * (node_count - 1);
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
  graph.settle_costs(all);
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
  graph.lists_.reserve(lists_.size());
  graph.neighbours_.reserve(neighbours_.size());
  graph.costs_.reserve(costs_.size());
  for (NodeId node = 0; node < node_count(); ++node) {
    for (int i = 0; i < degree(node); ++i) {
      const NodeId next = neighbours(node)[i];
      if (dropped[node] || dropped[next]) continue;
      graph.neighbours_.push_back(next);
      if (weighted()) graph.costs_.push_back(cost(node, i));
    }
    graph.close_node();
  }
  graph.settle_costs();
  return graph;
}

Graph Graph::from_lists(std::vector<std::int64_t> offsets, std::vector<NodeId> neighbours) {
  Graph graph;
  graph.neighbours_ = std::move(neighbours);
  graph.arc_count_ = std::ssize(graph.neighbours_);
  graph.lists_.reserve(offsets.size() - 1);
  for (std::size_t node = 0; node + 1 < offsets.size(); ++node) {
    const auto size = static_cast<std::int32_t>(offsets[node + 1] - offsets[node]);
    graph.lists_.push_back({.begin = offsets[node], .size = size, .room = size});
  }
  return graph;
}

NodeId Graph::add_node() {
  lists_.push_back({.begin = std::ssize(neighbours_), .size = 0, .room = 0});
  return node_count() - 1;
}

void Graph::add_edge(const Edge& edge, const Places& places) {
  if (costs_.empty() && edge.cost != 1) {
    costs_.assign(std::max<std::size_t>(neighbours_.size(), 1), 1);  // not empty: from now on edges have costs
    cost_sum_ = static_cast<double>(arc_count_);
  }
  insert_arc(edge.a, edge.b, edge.cost, places.of_b);
  if (!directed()) insert_arc(edge.b, edge.a, edge.cost, places.of_a);
  if (costs_.empty()) return;
  const int arcs = directed() ? 1 : 2;
  CostSum all = CostSum::of(edge.cost);
  all.sum = cost_sum_ + arcs * edge.cost;
  if (arc_count_ > arcs) {
    all.least = std::min(all.least, min_cost_);
    all.most = std::max(all.most, max_cost_);
    all.integers = all.integers && integer_costs_;
  }
  settle_costs(all);
}

void Graph::insert_arc(NodeId from, NodeId to, double cost, int place) {
  List& list = lists_[from];
  if (list.size == list.room) {
    // To the end of all lists, with room for as many again.
    const std::int64_t begin = std::ssize(neighbours_);
    list.room = std::max(4, 2 * list.size);
    neighbours_.resize(begin + list.room);
    std::copy_n(neighbours_.begin() + list.begin, list.size, neighbours_.begin() + begin);
    if (!costs_.empty()) {
      costs_.resize(neighbours_.size());
      std::copy_n(costs_.begin() + list.begin, list.size, costs_.begin() + begin);
    }
    list.begin = begin;
  }
  const auto first = neighbours_.begin() + list.begin;
  if (place < 0) place = static_cast<int>(std::upper_bound(first, first + list.size, to) - first);
  std::copy_backward(first + place, first + list.size, first + list.size + 1);
  first[place] = to;
  if (!costs_.empty()) {
    const auto first_cost = costs_.begin() + list.begin;
    std::copy_backward(first_cost + place, first_cost + list.size, first_cost + list.size + 1);
    first_cost[place] = cost + 0.0;  // turns -0 into 0
  }
  ++list.size;
  ++arc_count_;
}

void Graph::remove_edge(NodeId from, NodeId to) {
  CostSum left{
      .sum = cost_sum_ - erase_arc(from, to), .least = min_cost_, .most = max_cost_, .integers = integer_costs_};
  if (!directed()) left.sum -= erase_arc(to, from);
  if (costs_.empty()) return;
  // Differences of costs that are no whole numbers may end a little below 0.
  if (arc_count_ == 0) left = {.least = 1, .most = 1};
  left.sum = std::max(left.sum, 0.0);
  settle_costs(left);
}

double Graph::erase_arc(NodeId from, NodeId to) {
  const int place = index_of(from, to);
  const double lost = cost(from, place);
  List& list = lists_[from];
  const auto lose = [&](auto& values) {
    const auto first = values.begin() + list.begin;
    std::copy(first + place + 1, first + list.size, first + place);
  };
  lose(neighbours_);
  if (!costs_.empty()) lose(costs_);
  --list.size;
  --arc_count_;
  return lost;
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
  settle_costs(all);
}

void Graph::settle_costs(const CostSum& all) {
  cost_sum_ = all.sum;
  min_cost_ = all.least;
  max_cost_ = all.most;
  mean_cost_ = all.sum > 0 ? all.sum / static_cast<double>(arc_count_) : 1;
  integer_costs_ = all.integers && all.sum < kExactIntegers;
}

}  // namespace graphdrl
