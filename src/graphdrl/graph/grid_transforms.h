// Grids for robots: obstacles grown by the robot's radius, cells of another size.
#pragma once

#include <cstdint>

#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

// Blocks every cell whose centre is nearer to a blocked cell than the radius, in sides of a cell. What lies beyond the
// border is no obstacle. Cost: O(cells · radius).
GridMap with_obstacles_grown(GridMap map, double radius);

// Larger cells, `scale` sides of a cell of the map each, from the lower left corner; they need not be whole cells of
// it. One is free where all of the map's cells that it touches are. What is left of the map beyond the last whole one
// is lost. Keeps the frame's corner. REQUIRES: scale >= 1 and at most the shorter side of the map.
GridMap coarsened(const GridMap& map, double scale);

// How many cells are free.
std::int64_t count_free(const GridMap& map);

}  // namespace graphdrl
