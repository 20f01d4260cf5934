// Graphs as lists of edges, one a line: what networkx, igraph, SNAP and spreadsheets write.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether the first line that is no comment has two fields or more. Its reader refuses a text of which a later line is
// no edge.
bool is_edge_list(std::string_view text);

// Two nodes a line, and a cost, 1 unless given. Fields stand between tabs, semicolons or commas, whichever the first
// line has, in "quotes" where they contain one, or else between spaces; Excel's first line "sep=;" names what parts
// them. Where that is no comma, a cost may have a decimal comma. Lines that begin with '#' or '%' are comments.
// A first line that names a column `source`, `from`, `src` or `u` and one `target`, `to`, `dst` or `v` is a header, and
// so is a line of names, none of which is a node below. Columns may stand in any order, and `weight`, `cost`, `length`
// or `distance` is the cost. Without a header, the cost is the third field; it may be a Python dictionary, as networkx
// writes it: {'weight': 2.5}. Other columns are skipped. Edges lead both ways, but one way where options.directed, a
// comment above them ("# Directed graph") or their column `type` says so ("Directed", as Gephi writes it). Node ids are
// any texts; nodes are numbered as they come. Tells options.note that it was taken for an edge list, and what was
// guessed. Throws Error, naming `source` and the line, on anything else, a table of coordinates too.
GraphMap parse_edge_list(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
