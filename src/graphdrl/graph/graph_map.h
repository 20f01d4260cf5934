// Graphs as files hold them.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/point.h"

namespace graphdrl {

// What a file says of the walk: its budget, its start and its end, if it says any of them.
struct GivenTask {
  std::optional<double> budget;  // in units of cost
  NodeId start = kNoNode;
  NodeId end = kNoNode;
};

// All edges of a file, in its order, where some are loops or parallel, or have labels. Testers' models are like that: a
// state machine has transitions that lead back to their state, and several from one state to another. Walks over nodes
// never gain by such edges, so Graph does without them.
struct Multigraph {
  std::vector<Edge> edges;               // from a to b; in an undirected graph either way
  std::vector<std::string> labels = {};  // [edges]; empty where no edge has one
  std::vector<double> prizes = {};       // [edges], what walking one for the first time is worth; empty where that is 1

  std::int64_t loops() const {
    return std::ranges::count_if(edges, [](const Edge& edge) { return edge.a == edge.b; });
  }
  bool weighted() const {
    return std::ranges::any_of(edges, [](const Edge& edge) { return edge.cost != 1; });
  }
  // [edges], of a directed graph: those that lead back, too, and are one all the same; empty where none does. A graph
  // that has both kinds is mixed.
  std::vector<bool> both_ways = {};

  bool leads_back(std::size_t edge) const { return !both_ways.empty() && both_ways[edge]; }
  // With the ways back as edges of their own: [edges], and the ways back.
  std::vector<Edge> arcs() const {
    std::vector<Edge> arcs = edges;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (leads_back(i) && edges[i].a != edges[i].b) arcs.push_back({edges[i].b, edges[i].a, edges[i].cost});
    }
    return arcs;
  }
  double prize(std::size_t edge) const { return prizes.empty() ? 1 : prizes[edge]; }
  // What an edge is called; empty where it has no label.
  std::string label(std::size_t edge) const { return labels.empty() ? "" : labels[edge]; }
  // Edges beside another one between the same nodes. graph: the simple graph of these edges.
  std::int64_t parallel_edges(const Graph& graph) const { return std::ssize(arcs()) - loops() - graph.edge_count(); }
};

// A graph with its obstacles.
struct GraphMap {
  Graph graph;
  std::vector<bool> blocked;             // [N]
  std::vector<std::string> labels = {};  // [N], what the file calls its nodes; empty where that is 0 … N - 1
  std::vector<double> prizes = {};       // [N], what a first visit is worth; empty where that is 1 everywhere
  Places places = {};                    // where they lie
  GivenTask task = {};
  std::shared_ptr<const Multigraph> multigraph = {};  // null where `graph` has all edges, and they have no labels
};

// The edges of a map as its file holds them, loops and parallel ones too.
inline Multigraph all_edges(const GraphMap& map) {
  return map.multigraph ? *map.multigraph : Multigraph{.edges = map.graph.edges()};
}

// The same with each way back as an edge of its own, for files that do not know edges of both kinds.
inline Multigraph one_way(const Multigraph& all) {
  if (all.both_ways.empty()) return all;
  Multigraph arcs = all;
  arcs.both_ways.clear();
  arcs.edges = all.arcs();
  for (std::size_t i = 0; i < all.edges.size(); ++i) {
    if (!all.leads_back(i) || all.edges[i].a == all.edges[i].b) continue;
    if (!all.labels.empty()) arcs.labels.push_back(all.labels[i]);
    if (!all.prizes.empty()) arcs.prizes.push_back(all.prizes[i]);
  }
  return arcs;
}

// Gives a map edges, and their list where its graph does not say all of it.
inline void set_edges(GraphMap& map, NodeId node_count, Multigraph all, EdgeKind kind) {
  map.graph = Graph::from_edges(node_count, all.arcs(), kind);
  if (std::ranges::all_of(all.prizes, [](double prize) { return prize == 1; })) all.prizes.clear();
  const bool plain = all.labels.empty() && all.prizes.empty() && all.both_ways.empty();
  const bool whole = plain && std::ssize(all.edges) == map.graph.edge_count();
  map.multigraph = whole ? nullptr : std::make_shared<const Multigraph>(std::move(all));
}

}  // namespace graphdrl
