// Grid maps as text, and when a walk first visits their cells.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "graphdrl/env/world.h"

namespace graphdrl {

// One character per cell: '.' free, '#' blocked. REQUIRES: world.has_cells().
std::string draw_map_text(const World& world);
// The step at which each node was first visited; -1 if never. [N]
std::vector<int> first_visits(const World& world, std::span<const NodeId> walk);

}  // namespace graphdrl
