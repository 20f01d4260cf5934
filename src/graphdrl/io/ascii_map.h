// Maps as text: one row per line, '.' a free cell, '#' a blocked one.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Line ends may be "\n" or "\r\n"; empty lines at the end are skipped. Throws Error, naming `source`, line and column,
// on any other character, on rows of unequal length and on a map without a free cell.
GridMap parse_ascii_map(std::string_view text, const std::string& source);

std::string format_ascii_map(const GridMap& map);

}  // namespace graphdrl
