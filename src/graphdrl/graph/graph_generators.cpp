#include "graphdrl/graph/graph_generators.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace graphdrl {
namespace {

int draw_node(int nodes, Rng& rng) {
  return static_cast<int>(rng.below(static_cast<std::uint32_t>(nodes)));
}

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
  std::vector<Edge> edges;
  for (int a = 0; a < nodes; ++a) {
    for (int b = a + 1; b < nodes; ++b) {
      if (rng.uniform() < p) edges.push_back({a, b});
    }
  }
  return Graph::from_edges(nodes, edges);
}

Graph barabasi_albert_graph(int nodes, int links, Rng& rng) {
  std::vector<Edge> edges;
  std::vector<int> ends = {0};  // each node as often as it has edges, the first once more
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
  std::vector<std::vector<bool>> matrix(nodes, std::vector<bool>(nodes));
  const auto set = [&](int a, int b, bool value) { matrix[a][b] = matrix[b][a] = value; };
  for (int node = 0; node < nodes; ++node) {
    for (int step = 1; step <= reach && step < nodes; ++step) set(node, (node + step) % nodes, true);
  }
  for (int step = 1; step <= reach && step < nodes; ++step) {
    for (int node = 0; node < nodes; ++node) {
      const int old = (node + step) % nodes;
      if (rng.uniform() >= rewired) continue;
      const int next = draw_node(nodes, rng);
      if (next == node || matrix[node][next]) continue;
      set(node, old, false);
      set(node, next, true);
    }
  }
  std::vector<Edge> edges;
  for (int a = 0; a < nodes; ++a) {
    for (int b = a + 1; b < nodes; ++b) {
      if (matrix[a][b]) edges.push_back({a, b});
    }
  }
  return Graph::from_edges(nodes, edges);
}

Graph geometric_graph(int nodes, double mean_degree, bool lengths_cost, Rng& rng) {
  const double radius = std::sqrt(mean_degree / (std::numbers::pi * nodes));
  std::vector<double> x(nodes);
  std::vector<double> y(nodes);
  for (int node = 0; node < nodes; ++node) {
    x[node] = rng.uniform();
    y[node] = rng.uniform();
  }
  std::vector<Edge> edges;
  double sum = 0;
  for (int a = 0; a < nodes; ++a) {
    for (int b = a + 1; b < nodes; ++b) {
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
  std::vector<NodeId> largest;
  std::vector<bool> seen(graph.node_count());
  for (NodeId start = 0; start < graph.node_count(); ++start) {
    if (seen[start]) continue;
    std::vector<NodeId> part = {start};
    seen[start] = true;
    for (std::size_t head = 0; head < part.size(); ++head) {
      for (const NodeId next : graph.neighbours(part[head])) {
        if (seen[next]) continue;
        seen[next] = true;
        part.push_back(next);
      }
    }
    if (part.size() > largest.size()) largest = std::move(part);
  }
  std::sort(largest.begin(), largest.end());
  std::vector<NodeId> number(graph.node_count(), kNoNode);
  for (std::size_t i = 0; i < largest.size(); ++i) number[largest[i]] = static_cast<NodeId>(i);
  std::vector<Edge> edges;
  for (const Edge& edge : graph.edges()) {
    if (number[edge.a] != kNoNode) edges.push_back({number[edge.a], number[edge.b], edge.cost});
  }
  return Graph::from_edges(static_cast<NodeId>(largest.size()), edges);
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
