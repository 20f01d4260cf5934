#include "graphdrl/graph/graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

Graph Graph::from_edges(NodeId node_count, std::span<const Edge> edges, EdgeKind kind) {
  struct Arc {
    NodeId to;
    double cost;
  };
  std::vector<std::vector<Arc>> lists(node_count);
  for (const Edge& edge : edges) {
    for (const NodeId end : {edge.a, edge.b}) {
      if (end < 0 || end >= node_count) {
        throw Error({.what = "edge to a node that is not there",
                     .expected = fmt::format("node ids 0 to {}", node_count - 1),
                     .got = fmt::format("{}", end)});
      }
    }
    if (!(edge.cost > 0) || !std::isfinite(edge.cost)) {
      throw Error({.what = fmt::format("bad cost of the edge from {} to {}", edge.a, edge.b),
                   .expected = "a positive finite number",
                   .got = fmt::format("{}", edge.cost)});
    }
    if (edge.a == edge.b) continue;
    lists[edge.a].push_back({edge.b, edge.cost});
    if (kind == EdgeKind::kUndirected) lists[edge.b].push_back({edge.a, edge.cost});
  }
  Graph graph;
  graph.kind_ = kind;
  for (auto& list : lists) {
    std::sort(list.begin(), list.end(), [](const Arc& one, const Arc& other) {
      return one.to != other.to ? one.to < other.to : one.cost < other.cost;
    });
    const auto same = [](const Arc& one, const Arc& other) { return one.to == other.to; };
    list.erase(std::unique(list.begin(), list.end(), same), list.end());
    for (const Arc& arc : list) {
      graph.neighbours_.push_back(arc.to);
      graph.costs_.push_back(arc.cost);
    }
    graph.close_node();
  }
  graph.forget_unit_costs();
  return graph;
}

Graph Graph::grid(int rows, int cols) {
  Graph graph;
  for (NodeId node = 0; node < rows * cols; ++node) {
    for (const Direction direction : kAllDirections) {
      const NodeId next = grid_neighbour(rows, cols, node, direction);
      if (next != kNoNode) graph.neighbours_.push_back(next);
    }
    graph.close_node();
  }
  return graph;
}

Graph Graph::grid(int rows, int cols, const std::vector<bool>& blocked) {
  Graph graph;
  graph.offsets_.reserve(blocked.size() + 1);
  for (NodeId node = 0; node < rows * cols; ++node) {
    for (const Direction direction : kAllDirections) {
      const NodeId next = blocked[node] ? kNoNode : grid_neighbour(rows, cols, node, direction);
      if (next != kNoNode && !blocked[next]) graph.neighbours_.push_back(next);
    }
    graph.close_node();
  }
  return graph;
}

int Graph::index_of(NodeId node, NodeId next) const {
  const auto all = neighbours(node);
  // Lists longer than a grid's are in ascending order.
  const auto place = all.size() > kAllDirections.size() ? std::lower_bound(all.begin(), all.end(), next)
                                                        : std::find(all.begin(), all.end(), next);
  return place == all.end() || *place != next ? -1 : static_cast<int>(place - all.begin());
}

Graph Graph::without(const std::vector<bool>& dropped) const {
  Graph graph;
  graph.kind_ = kind_;
  for (NodeId node = 0; node < node_count(); ++node) {
    for (int i = 0; i < degree(node); ++i) {
      const NodeId next = neighbours(node)[i];
      if (dropped[node] || dropped[next]) continue;
      graph.neighbours_.push_back(next);
      graph.costs_.push_back(cost(node, i));
    }
    graph.close_node();
  }
  graph.forget_unit_costs();
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

double Graph::mean_cost() const {
  if (costs_.empty()) return 1;
  double sum = 0;
  for (const double cost : costs_) sum += cost;
  return sum / static_cast<double>(costs_.size());
}

double Graph::min_cost() const {
  return costs_.empty() ? 1 : *std::min_element(costs_.begin(), costs_.end());
}

double Graph::max_cost() const {
  return costs_.empty() ? 1 : *std::max_element(costs_.begin(), costs_.end());
}

bool Graph::integer_costs() const {
  double sum = 0;
  for (const double cost : costs_) {
    if (cost != std::floor(cost)) return false;
    sum += cost;
  }
  return sum < 0x1p53;
}

std::vector<Edge> Graph::edges() const {
  std::vector<Edge> edges;
  for (NodeId node = 0; node < node_count(); ++node) {
    for (int i = 0; i < degree(node); ++i) {
      const NodeId next = neighbours(node)[i];
      if (directed() || node < next) edges.push_back({node, next, cost(node, i)});
    }
  }
  return edges;
}

void Graph::forget_unit_costs() {
  if (std::all_of(costs_.begin(), costs_.end(), [](double cost) { return cost == 1; })) costs_.clear();
}

}  // namespace graphdrl
