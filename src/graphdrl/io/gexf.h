// Graphs as GEXF, Gephi's own format.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text is XML with an element `gexf`.
bool is_gexf(std::string_view text);

// One graph [gexf.net], directed where it or one of its edges says so; other edges lead both ways then. Attributes by
// their usual names (`title`) [attributes.h], defaults too; `weight` of edges, `label` and `viz:position` of nodes.
// Nodes within nodes are nodes of the graph. Throws Error, naming `source` and mostly the line, on XML that is not well
// formed, on no graph, on an id that is used twice or missing, and on values out of range.
GraphMap parse_gexf(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
