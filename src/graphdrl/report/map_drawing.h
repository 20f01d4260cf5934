// Pictures of grid maps and of walks on them.
#pragma once

#include <span>
#include <string>

#include "graphdrl/env/world.h"

namespace graphdrl {

// One character per cell without a walk ('.' free, '#' blocked). With one, each visited cell shows the step of its
// first visit. REQUIRES: world.is_grid(); the walk, which may be empty, is valid.
std::string draw_map_text(const World& world, std::span<const NodeId> walk);

// The grid graph as an SVG picture, as in the paper's Figure 1: free nodes with their edges, blocked ones in red; a
// walk as a line from its start (ring) to its end (arrow head), set off where it runs over an edge again. Same
// requirements.
std::string draw_map_svg(const World& world, std::span<const NodeId> walk);

}  // namespace graphdrl
