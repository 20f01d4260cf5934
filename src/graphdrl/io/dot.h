// Graphs in Graphviz's language, DOT.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text begins with `graph` or `digraph`, `strict` or not, and a brace follows.
bool is_dot(std::string_view text);

// One graph [graphviz.org/doc/info/lang.html], graphs within it, defaults of nodes and edges, and ports. Nodes are
// numbered as they come. Attributes by their usual names [attributes.h]; `pos`, "x,y", is where a node lies. Throws
// Error, naming `source` and the line, on anything else. (Boost.Graph's reader, 1.74, knows no graphs without a name.)
GraphMap parse_dot(std::string_view text, const std::string& source, const MapOptions& options = {});

// Ends with a line break. Keeps all but the task, loops and parallel edges.
std::string format_dot(const GraphMap& map);
// The same with one more attribute.
std::string format_dot(const GraphMap& map, const NodeColumn& column);

// A text in quotes, as DOT writes it.
std::string dot_quoted(std::string_view text);

}  // namespace graphdrl
