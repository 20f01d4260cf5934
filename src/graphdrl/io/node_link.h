// Any graph as JSON in node-link form, as networkx's node_link_data and D3 write it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/graph_map.h"
#include "graphdrl/io/map_options.h"

namespace graphdrl {

// An attribute of nodes that is not the map's own.
struct NodeColumn {
  std::string name = {};
  std::vector<std::string> values = {};  // [N]; empty texts are left out
};

// {"directed": false, "nodes": [{"id": "a", "blocked": true, "prize": 3}, …], "links": [{"source": "a", "target": "b",
// "weight": 2}, …]}
//
// Nodes are numbered as they stand. Ids are whole numbers, texts or lists of them, which become texts like "(0, 1)".
// Attributes by their usual names [attributes.h]; {"graph": {"unit": "m"}} is the coordinates' unit; `links` may be
// called `edges`; keys may stand in any order, others are skipped. Throws Error, naming `source` and the place, on
// anything else, on an id used twice and on a graph without a free node. Cost: linear, without a copy of the document;
// the text is read twice where links stand before nodes.
GraphMap parse_node_link(std::string_view text, const std::string& source, const MapOptions& options = {});

// Ends with a line break.
std::string format_node_link(const GraphMap& map);

// The same of parts that stand elsewhere; labels, prizes and places may be empty.
std::string format_node_link(const Graph& graph, const std::vector<bool>& blocked,
                             std::span<const std::string> labels = {}, std::span<const double> prizes = {},
                             const Places& places = {});

}  // namespace graphdrl
