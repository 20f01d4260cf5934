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

// Steps to the left and up, to the right and up, to the right and down, to the left and down.
constexpr std::array<Cell, 4> kDiagonalSteps = {{{-1, -1}, {-1, 1}, {1, 1}, {1, -1}}};
constexpr std::span<const Cell> kDiagonals = kDiagonalSteps;
constexpr std::size_t kMostGridNeighbours = kAllDirections.size() + kDiagonalSteps.size();

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

// Arcs by the node they leave.
struct ArcLists {
  std::vector<Arc> arcs;
  std::vector<std::int64_t> ends;  // [N], where a node's arcs end and those of the next one begin
};

// A counting sort, linear in nodes and edges.
ArcLists arcs_by_node(NodeId node_count, std::span<const Edge> edges, EdgeKind kind) {
  const bool both_ways = kind == EdgeKind::kUndirected;
  ArcLists lists{.arcs = {}, .ends = std::vector<std::int64_t>(node_count)};
  for (const Edge& edge : edges) {
    if (edge.a == edge.b) continue;
    ++lists.ends[edge.a];
    if (both_ways) ++lists.ends[edge.b];
  }
  std::exclusive_scan(lists.ends.begin(), lists.ends.end(), lists.ends.begin(), std::int64_t{0});
  lists.arcs.resize(edges.size() * (both_ways ? 2 : 1));
  for (const Edge& edge : edges) {
    if (edge.a == edge.b) continue;
    const double cost = edge.cost + 0.0;  // turns -0 into 0
    lists.arcs[lists.ends[edge.a]++] = {edge.b, cost};
    if (both_ways) lists.arcs[lists.ends[edge.b]++] = {edge.a, cost};
  }
  return lists;
}

}  // namespace

Graph Graph::from_edges(NodeId node_count, std::span<const Edge> edges, EdgeKind kind) {
  check_edges(node_count, edges);
  ArcLists lists = arcs_by_node(node_count, edges, kind);
  const bool unit_costs = std::all_of(edges.begin(), edges.end(), [](const Edge& edge) { return edge.cost == 1; });
  Graph graph;
  graph.kind_ = kind;
  graph.offsets_.reserve(static_cast<std::size_t>(node_count) + 1);
  graph.neighbours_.reserve(lists.arcs.size());
  if (!unit_costs) graph.costs_.reserve(lists.arcs.size());
  std::int64_t begin = 0;
  for (const std::int64_t end : lists.ends) {
    const std::span<Arc> list(lists.arcs.data() + begin, lists.arcs.data() + end);
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
  Graph graph;
  const auto nodes = static_cast<std::size_t>(rows) * cols;
  graph.offsets_.reserve(nodes + 1);
  graph.neighbours_.reserve(kAllDirections.size() * nodes);
  for (NodeId node = 0; node < rows * cols; ++node) {
    for (const Direction direction : kAllDirections) {
      const NodeId next = grid_neighbour(rows, cols, node, direction);
      if (next != kNoNode) graph.neighbours_.push_back(next);
    }
    graph.close_node();
  }
  return graph;
}

Graph Graph::grid(const GridMap& map) {
  Graph graph;
  graph.offsets_.reserve(map.blocked.size() + 1);
  const auto free = [&](const Cell& cell) { return map.contains(cell) && !map.blocked[map.node(cell)]; };
  const auto add = [&](NodeId node, double cost) {
    graph.neighbours_.push_back(node);
    if (map.diagonals) graph.costs_.push_back(cost);
  };
  for (NodeId node = 0; node < map.rows * map.cols; ++node) {
    if (!map.blocked[node]) {
      for (const Direction direction : kAllDirections) {
        const NodeId next = grid_neighbour(map.rows, map.cols, node, direction);
        if (next != kNoNode && !map.blocked[next]) add(next, 1);
      }
      const Cell at = map.cell(node);
      for (const Cell step : map.diagonals ? kDiagonals : std::span<const Cell>()) {
        const Cell to{at.row + step.row, at.col + step.col};
        if (!free(to)) continue;
        if (!map.cut_corners && !(free({at.row, to.col}) && free({to.row, at.col}))) continue;
        add(map.node(to), std::numbers::sqrt2);
      }
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
  // What is known of the costs from each node to those after it. Sums run in the order of the nodes.
  struct Row {
    double sum = 0;
    double least = std::numeric_limits<double>::infinity();
    double most = 0;
    bool integers = true;
  };
  std::vector<Row> rows(node_count);
  const auto fill = [&](NodeId node) {
    Row row;
    for (NodeId other = node + 1; other < node_count; ++other) {
      const double cost = graph.pair_costs_->cost(node, other);
      row.sum += cost;
      row.least = std::min(row.least, cost);
      row.most = std::max(row.most, cost);
      row.integers = row.integers && cost == std::floor(cost);
    }
    rows[node] = row;
  };
  constexpr NodeId kBatch = 256;  // of rows, after which progress is told
  for (NodeId begin = 0; begin < node_count; begin += kBatch) {
    parallel_for(std::min(kBatch, node_count - begin), [&](int i) { fill(begin + i); });
    const double left = 1 - static_cast<double>(std::min(begin + kBatch, node_count)) / node_count;
    if (progress) progress(1 - left * left);
  }
  Row all;
  for (const Row& row : rows) {
    all.sum += row.sum;
    all.least = std::min(all.least, row.least);
    all.most = std::max(all.most, row.most);
    all.integers = all.integers && row.integers;
  }
  graph.min_cost_ = all.least;
  graph.max_cost_ = all.most;
  graph.mean_cost_ = all.sum > 0 ? all.sum / static_cast<double>(graph.edge_count()) : 1;
  graph.integer_costs_ = all.integers && 2 * all.sum < kExactIntegers;
  return graph;
}

int Graph::index_of(NodeId node, NodeId next) const {
  if (is_complete()) {
    const NodeId place = next > node ? next - node - 1 : next - node - 1 + node_count();
    return next < 0 || next >= node_count() || next == node ? -1 : place;
  }
  const auto all = neighbours(node);
  // Lists longer than a grid's are in ascending order.
  const auto place = all.size() > kMostGridNeighbours ? std::lower_bound(all.begin(), all.end(), next)
                                                      : std::find(all.begin(), all.end(), next);
  return place == all.end() || *place != next ? -1 : static_cast<int>(place - all.begin());
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

Graph Graph::induced(std::span<const NodeId> nodes, std::vector<NodeId>& number) const {
  for (std::size_t i = 0; i < nodes.size(); ++i) number[nodes[i]] = static_cast<NodeId>(i);
  Graph graph;
  graph.kind_ = kind_;
  graph.offsets_.reserve(nodes.size() + 1);
  for (const NodeId node : nodes) {
    const auto all = neighbours(node);
    for (int i = 0; i < std::ssize(all); ++i) {
      if (number[all[i]] == kNoNode) continue;
      graph.neighbours_.push_back(number[all[i]]);
      if (weighted()) graph.costs_.push_back(cost(node, i));
    }
    graph.close_node();
  }
  for (const NodeId node : nodes) number[node] = kNoNode;
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
  Graph graph;
  graph.kind_ = kind_;
  graph.offsets_.assign(offsets_.size(), 0);
  for (const NodeId next : neighbours_) ++graph.offsets_[next + 1];
  std::partial_sum(graph.offsets_.begin(), graph.offsets_.end(), graph.offsets_.begin());
  graph.neighbours_.resize(neighbours_.size());
  graph.costs_.resize(costs_.size());
  std::vector<std::int64_t> place = graph.offsets_;
  for (NodeId node = 0; node < node_count(); ++node) {
    for (std::int64_t i = offsets_[node]; i < offsets_[node + 1]; ++i) {
      const std::int64_t at = place[neighbours_[i]]++;
      graph.neighbours_[at] = node;
      if (weighted()) graph.costs_[at] = costs_[i];
    }
  }
  graph.settle_costs();
  return graph;
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
  double sum = 0;
  bool integers = true;
  for (const double cost : costs_) {
    sum += cost;
    integers = integers && cost == std::floor(cost);
  }
  const auto [least, most] = std::minmax_element(costs_.begin(), costs_.end());
  min_cost_ = *least;
  max_cost_ = *most;
  mean_cost_ = sum > 0 ? sum / static_cast<double>(costs_.size()) : 1;
  integer_costs_ = integers && sum < kExactIntegers;
}

}  // namespace graphdrl
