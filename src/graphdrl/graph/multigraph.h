// What a simple graph leaves out: loops, parallel edges and what edges are called.
#pragma once

#include <string>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// All edges of a file, in its order, where some are loops or parallel, or have labels. Testers' models are like that: a
// state machine has transitions that lead back to their state, and several from one state to another. Walks over nodes
// never gain by such edges, so Graph does without them.
struct Multigraph {
  std::vector<Edge> edges;               // from a to b; in an undirected graph either way
  std::vector<std::string> labels = {};  // [edges]; empty where no edge has one

  std::int64_t loops() const {
    std::int64_t count = 0;
    for (const Edge& edge : edges) count += edge.a == edge.b;
    return count;
  }
  // Edges beside another one between the same nodes. graph: the simple graph of these edges.
  std::int64_t parallel_edges(const Graph& graph) const { return std::ssize(edges) - loops() - graph.edge_count(); }
};

}  // namespace graphdrl
