// Graphs of Pajek, what networkx and igraph write as `.net`.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether the first line that is no comment begins with `*Vertices` or `*Network`.
bool is_pajek(std::string_view text);

// *Vertices N, then lines `1 "label" x y`; *Edges and *Arcs with lines `1 2 cost`, *Edgeslist and *Arcslist with lines
// `1 2 3`, a node and its neighbours, *Matrix with a row of costs a node, 0 for no edge [Batagelj and Mrvar 1998].
// Nodes are numbered from 1; those without a line are called by their numbers. One arc makes the graph directed. Lines
// that begin with '%' are comments. Throws Error, naming `source` and the line, on anything else, and where a file
// claims far more nodes than it has bytes.
GraphMap parse_pajek(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
