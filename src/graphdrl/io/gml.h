// Graphs in the Graph Modelling Language, what networkx, igraph, Gephi and yEd write.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text has the key `graph` with a list, and begins as a list of keys does.
bool is_gml(std::string_view text);

// One graph [Himsolt 1997]: graph [ directed 0 node [ id 1 label "a" graphics [ x 0 y 2 ] ] edge [ source 1 target 2
// weight 3 ] ]. Attributes by their usual names [attributes.h]; coordinates may stand in `graphics`; others are
// skipped. Throws Error, naming `source` and the line, on anything else.
GraphMap parse_gml(std::string_view text, const std::string& source, const MapOptions& options = {});

// Ends with a line break. Keeps all but the task, loops and parallel edges. What is not ASCII in labels is written as
// &#N;, as the format asks.
std::string format_gml(const GraphMap& map);

}  // namespace graphdrl
