// Graphs in the formats of DIMACS' challenges.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether the first line that is no comment (`c …`) is a problem of these formats.
bool is_dimacs(std::string_view text);

// `p edge N M` or `p col N M` and lines `e U V`: undirected, every edge costs 1 [DIMACS 1993, cliques and colouring].
// `p sp N M` and lines `a U V COST`: directed [DIMACS 2006, shortest paths]. Nodes are numbered from 1, and labelled
// so. Throws Error, naming `source` and the line, on anything else, and where the file holds another number of edges
// than it says; of undirected ones it may hold or say each twice.
GraphMap parse_dimacs(std::string_view text, const std::string& source);

}  // namespace graphdrl
