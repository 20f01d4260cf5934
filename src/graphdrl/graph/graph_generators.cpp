#include "graphdrl/graph/graph_generators.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

// The frozen splits draw a number per pair of nodes up to this size.
constexpr int kMostNodesByPairs = 20'000;

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

}  // namespace

Graph random_tree(int nodes, Rng& rng) {
  // A walk on the complete graph: the edges by which it first enters each node.
  std::vector<Edge> edges;
  std::vector<bool> entered(nodes);
  int here = rng.index(nodes);
  entered[here] = true;
  while (std::ssize(edges) + 1 < nodes) {
    const int next = rng.index(nodes);
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
  return power_law_cluster_graph(nodes, links, 0, rng);
}

Graph power_law_cluster_graph(int nodes, int links, double triads, Rng& rng) {
  std::vector<std::vector<int>> joined(triads > 0 ? nodes : 0);
  std::vector<int> ends = {0};  // each node once per edge of it, the first node once more
  std::vector<Edge> edges;
  std::vector<int> chosen;
  std::vector<int> near;
  const auto is_chosen = [&](int other) { return std::ranges::find(chosen, other) != chosen.end(); };
  for (int node = 1; node < nodes; ++node) {
    chosen.clear();
    int drawn = 0;  // the last one by its degree
    while (std::ssize(chosen) < std::min(links, node)) {
      near.clear();
      if (triads > 0 && !chosen.empty() && rng.uniform() < triads) {
        std::ranges::remove_copy_if(joined[drawn], std::back_inserter(near), is_chosen);
      }
      if (!near.empty()) {
        chosen.push_back(near[rng.index(static_cast<int>(near.size()))]);
        continue;
      }
      drawn = ends[rng.below(static_cast<std::uint32_t>(ends.size()))];
      if (!is_chosen(drawn)) chosen.push_back(drawn);
    }
    for (const int other : chosen) {
      edges.push_back({other, node});
      ends.push_back(other);
      ends.push_back(node);
      if (triads == 0) continue;
      joined[other].push_back(node);
      joined[node].push_back(other);
    }
  }
  return Graph::from_edges(nodes, edges);
}

Graph watts_strogatz_graph(int nodes, int reach, double rewired, Rng& rng) {
  std::vector<std::vector<int>> ring(nodes);  // each node's neighbours, in no order
  const auto joined = [&](int a, int b) { return std::ranges::find(ring[a], b) != ring[a].end(); };
  const auto join = [&](int a, int b) {
    if (joined(a, b)) return;
    ring[a].push_back(b);
    ring[b].push_back(a);
  };
  for (int node = 0; node < nodes; ++node) {
    for (int step = 1; step <= reach && step < nodes; ++step) join(node, (node + step) % nodes);
  }
  for (int step = 1; step <= reach && step < nodes; ++step) {
    for (int node = 0; node < nodes; ++node) {
      if (rng.uniform() >= rewired) continue;
      const int next = rng.index(nodes);
      if (next == node || joined(node, next)) continue;
      const int old = (node + step) % nodes;
      std::erase(ring[node], old);
      std::erase(ring[old], node);
      join(node, next);
    }
  }
  std::vector<Edge> edges;
  for (int a = 0; a < nodes; ++a) {
    for (const int b : ring[a]) {
      if (a < b) edges.push_back({a, b});
    }
  }
  return Graph::from_edges(nodes, edges);
}

Graph geometric_graph(int nodes, double mean_degree, bool lengths_cost, Rng& rng) {
  const double radius = std::sqrt(mean_degree / (std::numbers::pi * nodes));
  std::vector<Point> places(nodes);
  for (Point& place : places) place = {rng.uniform(), rng.uniform()};
  // Nodes by the cells of a grid, a little wider than the radius, so that rounding leaves no near one out.
  const int side = std::max(1, static_cast<int>(std::min(0.999 / radius, std::sqrt(nodes))));
  std::vector<std::vector<int>> cells(static_cast<std::size_t>(side) * side);
  const auto cell_of = [&](int node) {
    return Cell{static_cast<int>(places[node].y * side), static_cast<int>(places[node].x * side)};
  };
  for (int node = 0; node < nodes; ++node) cells[cell_of(node).row * side + cell_of(node).col].push_back(node);
  std::vector<Edge> edges;
  std::vector<int> near;
  double sum = 0;
  for (int a = 0; a < nodes; ++a) {
    near.clear();
    const Cell at = cell_of(a);
    for (int row = std::max(at.row - 1, 0); row <= std::min(at.row + 1, side - 1); ++row) {
      for (int col = std::max(at.col - 1, 0); col <= std::min(at.col + 1, side - 1); ++col) {
        std::ranges::copy_if(cells[row * side + col], std::back_inserter(near), [&](int b) { return b > a; });
      }
    }
    std::sort(near.begin(), near.end());  // frozen splits hold sums of lengths in this order
    for (const int b : near) {
      const double length = length_between(places[a], places[b]);
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
  std::vector<NodeId> number(graph.node_count(), kNoNode);
  NodeId count = 0;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    if (components.of[node] == largest) number[node] = count++;
  }
  std::vector<Edge> edges = graph.edges();
  std::erase_if(edges, [&](const Edge& edge) { return number[edge.a] == kNoNode; });
  for (Edge& edge : edges) edge = {number[edge.a], number[edge.b], edge.cost};
  return Graph::from_edges(count, edges);
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
