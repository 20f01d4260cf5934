// The environments of the paper's author: NumPy arrays.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/map_formats.h"

namespace graphdrl {

bool is_numpy(std::string_view bytes);

// [2, N, N] in float64, float32 or whole numbers: the adjacency matrix, 0 for no edge, and a matrix with ones on the
// diagonal at obstacles; or [N, N], the adjacency matrix alone. Other values of it than 1 are costs. A matrix that is
// not symmetric gives a directed graph. Where N is a square and the edges are those of a grid, with those of obstacles
// or without, the map is a grid. Throws Error, naming `source`, on anything else.
AnyMap parse_numpy_map(std::string_view bytes, const std::string& source);

}  // namespace graphdrl
