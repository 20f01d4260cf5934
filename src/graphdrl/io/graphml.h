// Graphs as GraphML, what networkx, igraph, Gephi, yEd and Boost write.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text is XML with an element `graphml`.
bool is_graphml(std::string_view text);

// One graph [Brandes et al. 2002, graphml.graphdrawing.org], directed where it or one of its edges says so; an edge
// that does not lead one way leads both ways then. Attributes by their usual names (`attr.name`) [attributes.h],
// defaults too; yEd's texts and coordinates of nodes. Graphs within nodes, yEd's groups, are part of the graph; a node
// with a graph that no edge leads to is left out. Throws Error, naming `source` and mostly the line, on XML that is not
// well formed, on no graph or several, on edges between more than two nodes, on an id used twice, and on values out of
// range.
GraphMap parse_graphml(std::string_view text, const std::string& source, const MapOptions& options = {});

// Ends with a line break. Keeps all but the task, loops and parallel edges.
std::string format_graphml(const GraphMap& map);
// The same with one more attribute.
std::string format_graphml(const GraphMap& map, const NodeColumn& column);

}  // namespace graphdrl
