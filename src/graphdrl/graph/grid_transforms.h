// Grids for robots: obstacles grown by the robot's radius, cells of another size.
#pragma once

#include <cstdint>

#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Blocks every cell whose centre is nearer to a blocked cell than the radius, in sides of a cell. What lies beyond the
// border is no obstacle. Cost: O(cells · radius).
GridMap with_obstacles_grown(GridMap map, double radius);

// Larger cells of `scale` times the side, from the lower left corner; `scale` need not be a whole number. A larger cell
// is free if all cells of the map that it touches are. Cells beyond the last whole larger one are dropped. Keeps the
// frame's corner. REQUIRES: scale >= 1 and at most the shorter side of the map.
GridMap coarsened(const GridMap& map, double scale);

// How many cells are free.
std::int64_t count_free(const GridMap& map);

}  // namespace graphdrl
