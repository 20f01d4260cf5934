#include "graphdrl/graph/graph_generators.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

// The frozen splits draw a number per pair of nodes up to this size.
constexpr int kMostNodesByPairs = 20'000;

int draw_node(int nodes, Rng& rng) {
  return static_cast<int>(rng.below(static_cast<std::uint32_t>(nodes)));
}

std::vector<Edge> draw_edges_by_pairs(int nodes, double p, Rng& rng) {
  std::vector<Edge> edges;
  for (int a = 0; a < nodes; ++a) {
    for (int b = a + 1; b < nodes; ++b) {
      if (rng.uniform() < p) edges.push_back({a, b});
    }
  }
  return edges;
}

// Draws how many pairs to skip until the next edge, so that time grows with the edges [Batagelj and Brandes 2005].
std::vector<Edge> draw_edges_by_skips(int nodes, double p, Rng& rng) {
  std::vector<Edge> edges;
  if (!(p > 0)) return edges;
  const double log_not_p = std::log1p(-p);
  int b = 1;
  std::int64_t a = -1;  // the pairs (a, b) with a < b stand by b, then by a
  for (;;) {
    a += 1 + static_cast<std::int64_t>(std::log1p(-rng.uniform()) / log_not_p);
    while (b < nodes && a >= b) a -= b++;
    if (b >= nodes) return edges;
    edges.push_back({static_cast<NodeId>(a), b});
  }
}

// A graph under change: each node's neighbours, in no order.
class NeighbourLists {
 public:
  explicit NeighbourLists(int nodes) : lists_(nodes) {}

  bool has(int a, int b) const { return std::find(lists_[a].begin(), lists_[a].end(), b) != lists_[a].end(); }

  void add(int a, int b) {
    if (has(a, b)) return;
    lists_[a].push_back(b);
    lists_[b].push_back(a);
  }

  void remove(int a, int b) {
    std::erase(lists_[a], b);
    std::erase(lists_[b], a);
  }

  Graph graph() const {
    std::vector<Edge> edges;
    for (int a = 0; a < std::ssize(lists_); ++a) {
      for (const int b : lists_[a]) {
        if (a < b) edges.push_back({a, b});
      }
    }
    return Graph::from_edges(static_cast<NodeId>(lists_.size()), edges);
  }

 private:
  std::vector<std::vector<int>> lists_;
};

// Points of the unit square by the cells of a grid.
class PointGrid {
 public:
  // Cells are a little wider than `radius`, so that rounding leaves no near point out, and no more than the points.
  PointGrid(std::span<const double> x, std::span<const double> y, double radius)
      : side_(std::max(1, static_cast<int>(std::min(0.999 / radius, std::sqrt(static_cast<double>(x.size())))))),
        begin_(static_cast<std::size_t>(side_) * side_ + 1),
        points_(x.size()) {
    const auto cell = [&](std::size_t point) { return row_of(y[point]) * side_ + row_of(x[point]); };
    for (std::size_t point = 0; point < x.size(); ++point) ++begin_[cell(point) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<int> place(begin_.begin(), begin_.end() - 1);
    for (std::size_t point = 0; point < x.size(); ++point) points_[place[cell(point)]++] = static_cast<int>(point);
  }

  // Calls visit(point) for every point in the cell of (x, y) and in those around it.
  template <typename Visit>
  void for_each_near(double x, double y, const Visit& visit) const {
    const int first = std::max(row_of(x) - 1, 0);
    const int last = std::min(row_of(x) + 1, side_ - 1);
    for (int row = std::max(row_of(y) - 1, 0); row <= std::min(row_of(y) + 1, side_ - 1); ++row) {
      const int end = begin_[row * side_ + last + 1];
      for (int i = begin_[row * side_ + first]; i < end; ++i) visit(points_[i]);
    }
  }

 private:
  int row_of(double coordinate) const { return static_cast<int>(coordinate * side_); }  // coordinates are below 1

  int side_;
  std::vector<int> begin_;   // [cells + 1], where a cell's points begin
  std::vector<int> points_;  // by cell, ascending in each
};

}  // namespace

Graph random_tree(int nodes, Rng& rng) {
  // A walk on the complete graph: the edges by which it first enters each node.
  std::vector<Edge> edges;
  std::vector<bool> entered(nodes);
  int here = draw_node(nodes, rng);
  entered[here] = true;
  while (std::ssize(edges) + 1 < nodes) {
    const int next = draw_node(nodes, rng);
    if (!entered[next]) edges.push_back({here, next});
    entered[next] = true;
    here = next;
  }
  return Graph::from_edges(nodes, edges);
}

Graph erdos_renyi_graph(int nodes, double mean_degree, Rng& rng) {
  const double p = mean_degree / std::max(1, nodes - 1);
  const bool by_pairs = nodes <= kMostNodesByPairs;
  return Graph::from_edges(nodes, by_pairs ? draw_edges_by_pairs(nodes, p, rng) : draw_edges_by_skips(nodes, p, rng));
}

Graph barabasi_albert_graph(int nodes, int links, Rng& rng) {
  std::vector<Edge> edges;
  std::vector<int> ends = {0};  // each node once per edge of it, the first node once more
  for (int node = 1; node < nodes; ++node) {
    std::vector<int> chosen;
    while (std::ssize(chosen) < std::min(links, node)) {
      const int other = ends[draw_node(static_cast<int>(ends.size()), rng)];
      if (std::find(chosen.begin(), chosen.end(), other) == chosen.end()) chosen.push_back(other);
    }
    for (const int other : chosen) {
      edges.push_back({other, node});
      ends.push_back(other);
      ends.push_back(node);
    }
  }
  return Graph::from_edges(nodes, edges);
}

Graph watts_strogatz_graph(int nodes, int reach, double rewired, Rng& rng) {
  NeighbourLists ring(nodes);
  for (int node = 0; node < nodes; ++node) {
    for (int step = 1; step <= reach && step < nodes; ++step) ring.add(node, (node + step) % nodes);
  }
  for (int step = 1; step <= reach && step < nodes; ++step) {
    for (int node = 0; node < nodes; ++node) {
      const int old = (node + step) % nodes;
      if (rng.uniform() >= rewired) continue;
      const int next = draw_node(nodes, rng);
      if (next == node || ring.has(node, next)) continue;
      ring.remove(node, old);
      ring.add(node, next);
    }
  }
  return ring.graph();
}

Graph geometric_graph(int nodes, double mean_degree, bool lengths_cost, Rng& rng) {
  const double radius = std::sqrt(mean_degree / (std::numbers::pi * nodes));
  std::vector<double> x(nodes);
  std::vector<double> y(nodes);
  for (int node = 0; node < nodes; ++node) {
    x[node] = rng.uniform();
    y[node] = rng.uniform();
  }
  const PointGrid grid(x, y, radius);
  std::vector<Edge> edges;
  std::vector<int> near;
  double sum = 0;
  for (int a = 0; a < nodes; ++a) {
    near.clear();
    grid.for_each_near(x[a], y[a], [&](int b) {
      if (b > a) near.push_back(b);
    });
    std::sort(near.begin(), near.end());  // frozen splits hold sums of lengths in this order
    for (const int b : near) {
      const double length = std::hypot(x[a] - x[b], y[a] - y[b]);
      if (length >= radius || length == 0) continue;
      edges.push_back({a, b, length});
      sum += length;
    }
  }
  const double mean = sum / static_cast<double>(std::max<std::size_t>(1, edges.size()));
  for (Edge& edge : edges) edge.cost = lengths_cost ? edge.cost / mean : 1;
  return Graph::from_edges(nodes, edges);
}

Graph largest_part(const Graph& graph) {
  const Components components = find_components(graph, std::vector<bool>(graph.node_count()));
  const int largest = components.largest();
  std::vector<NodeId> nodes;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    if (components.of[node] == largest) nodes.push_back(node);
  }
  std::vector<NodeId> number(graph.node_count(), kNoNode);
  return graph.induced(nodes, number);
}

Graph with_random_costs(const Graph& graph, int most, Rng& rng) {
  std::vector<Edge> edges = graph.edges();
  for (Edge& edge : edges) edge.cost = 1 + rng.below(static_cast<std::uint32_t>(most));
  return Graph::from_edges(graph.node_count(), edges, graph.directed() ? EdgeKind::kDirected : EdgeKind::kUndirected);
}

Graph with_one_way_edges(const Graph& graph, double share, Rng& rng) {
  std::vector<Edge> arcs;
  for (const Edge& edge : graph.edges()) {
    const bool one_way = rng.uniform() < share;
    const bool forward = rng.below(2) == 0;
    if (!one_way || forward) arcs.push_back(edge);
    if (!one_way || !forward) arcs.push_back({edge.b, edge.a, edge.cost});
  }
  return Graph::from_edges(graph.node_count(), arcs, EdgeKind::kDirected);
}

}  // namespace graphdrl
