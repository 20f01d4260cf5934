// OPLib: orienteering problems in TSPLIB's format.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/map_options.h"
#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text begins with a keyword or a section of TSPLIB.
bool is_tsplib(std::string_view text);

// A complete graph with whole costs [Reinelt 1991, TSPLIB; github.com/bcamath-ds/OPLib]. TYPE OP or TSP,
// whatever comment follows; keywords and sections in any order.
// EDGE_WEIGHT_TYPE EUC_2D, CEIL_2D, GEO or ATT, whose costs are computed from NODE_COORD_SECTION when they are asked
// for, or EXPLICIT: FULL_MATRIX, symmetric, or UPPER_ROW, LOWER_ROW, UPPER_DIAG_ROW or LOWER_DIAG_ROW of
// EDGE_WEIGHT_SECTION. COST_LIMIT is the budget, NODE_SCORE_SECTION holds the prizes, 1 each where there is none, and
// the node of DEPOT_SECTION is start and end. Labels are the file's numbers, from 1. Numbers are finite, and in
// sections at most 1e15. Throws Error, naming `source` and mostly the line, on anything else, an unknown keyword too,
// and where something is missing or comes twice; only COMMENT may. Cost: O(N²).
GraphMap parse_tsplib(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
