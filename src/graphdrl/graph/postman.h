// The cheapest walks over all edges of a graph.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graphdrl/graph/graph_map.h"

namespace graphdrl {

// A walk as edges: their numbers in Multigraph::edges, or kResetEdge for a jump back to the start.
struct EdgeWalk {
  static constexpr std::int64_t kResetEdge = -1;

  std::vector<NodeId> nodes;             // every position, the start first
  std::vector<std::int64_t> edges = {};  // [steps]
  double cost = 0;
};

struct PostmanOptions {
  NodeId end = kNoNode;                   // where it must end; kNoNode: anywhere
  std::optional<double> reset_cost = {};  // of a jump from anywhere to the start; empty: there is none
};

// A walk over all edges, and what any such walk costs at least.
struct PostmanWalk {
  EdgeWalk walk;
  double bound;
};

// The cheapest walk from a node over every edge, loops and parallel ones too; an undirected edge counts either way. The
// edges of other components than the start's count as well: empty where no walk reaches them all.
//
// Directed: the Chinese postman by a flow of least cost [Edmonds and Johnson 1973]. Undirected: by a perfect matching
// of the odd nodes, of least cost; resets are then one-way edges, which makes the problem hard, so there are none.
// Mixed graphs are hard as well [Papadimitriou 1976]: a flow that may turn edges by halves is the bound. Edges are
// directed as it says, those that it leaves undecided by trying, and the rest is a directed graph [Frederickson 1979].
// Cost: a search for each unit of flow; the cube of the odd nodes, of which kMostOddNodes are taken. Throws Error on
// more, and on resets of undirected graphs.
inline constexpr int kMostOddNodes = 500;
bool has_too_many_odd_nodes(const Multigraph& graph, EdgeKind kind, NodeId node_count);
std::optional<PostmanWalk> postman_walk(const Multigraph& graph, EdgeKind kind, NodeId node_count, NodeId start,
                                        const PostmanOptions& options);

}  // namespace graphdrl
