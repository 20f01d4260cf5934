// Occupancy grids as tables of 0 and 1.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/graph/grid_map.h"
#include "graphdrl/io/map_options.h"

namespace graphdrl {

// Whether a text is rows of 0 and 1, of one length, and no list of edges between two nodes 0 and 1.
bool is_cell_table(std::string_view text);

// A row a line, 1 is blocked and 0 is free, with commas, semicolons, tabs, spaces or nothing between the cells. Tells
// options.note so. Throws Error, naming `source` and the line, on anything else, and where no cell is free.
GridMap parse_cell_table(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
