// Any graph as JSON in node-link form, as networkx's node_link_data and D3 write it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// A graph with its obstacles, as a file holds it.
struct GraphMap {
  Graph graph;
  std::vector<bool> blocked;        // [N]
  std::vector<std::string> labels;  // [N], what the file calls its nodes; empty where that is 0 … N - 1
};

// {"directed": false, "nodes": [{"id": "a", "blocked": true}, …], "links": [{"source": "a", "target": "b", "weight":
// 2}, …]}
//
// Nodes are numbered as they stand. Ids are numbers or texts; `blocked` is false and `weight`, also called `cost`, is 1
// unless given; `links` may be called `edges`; other keys are skipped. Throws Error, naming `source` and the place, on
// anything else, on an id used twice and on a graph without a free node.
GraphMap parse_node_link(std::string_view text, const std::string& source);

// Ends with a line break.
std::string format_node_link(const GraphMap& map);

}  // namespace graphdrl
