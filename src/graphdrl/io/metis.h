// Graphs of METIS and KaHIP, as partitioning programs read them.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text is such a file from end to end: as many lines and neighbours as its first line says.
bool is_metis(std::string_view text);

// `N M [FORMAT [WEIGHTS]]`, then a line for each node with its neighbours, numbered from 1, each followed by the cost
// of the edge where FORMAT ends in 1; sizes and weights of nodes are skipped [Karypis, METIS 5 manual]. Lines that
// begin with '%' are comments. Undirected; labels are the file's numbers. Throws Error, naming `source`, on anything
// else, and where an edge is listed at one of its ends only, or costs differ.
GraphMap parse_metis(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
