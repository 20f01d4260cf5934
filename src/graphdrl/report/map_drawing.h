// Grid maps and walks on them, as text.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "graphdrl/env/world.h"

namespace graphdrl {

// One character per cell without a walk ('.' free, '#' blocked). With one, each visited cell shows the step of its
// first visit. REQUIRES: world.has_cells(); the walk, which may be empty, is valid.
std::string draw_map_text(const World& world, std::span<const NodeId> walk);
// The step at which each node was first visited; -1 where never. [N]
std::vector<int> first_visits(const World& world, std::span<const NodeId> walk);

}  // namespace graphdrl
