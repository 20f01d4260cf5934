// MovingAI's grid maps: benchmarks from games, cities and mazes.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Whether a text begins as these files do.
bool is_moving_ai(std::string_view text);

// `type octile`, `height H`, `width W` and `map`, then H rows of W characters [Sturtevant 2012, movingai.com]. '.' and
// 'G' are ground, 'S', swamp, can be walked from it, and 'E' and 'S' are a warehouse's stations [League of Robot
// Runners]: free. '@' and 'O', out of bounds, 'T', trees, and 'W', water, which is not to be reached from ground:
// blocked. Throws Error, naming `source` and the line, on anything else, and where no cell is free.
GridMap parse_moving_ai(std::string_view text, const std::string& source);

// Free cells are '.', blocked ones '@'.
std::string format_moving_ai(const GridMap& map);

}  // namespace graphdrl
