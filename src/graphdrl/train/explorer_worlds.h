// The worlds that the explorer is trained on.
#pragma once

#include <vector>

#include "graphdrl/env/world_families.h"

namespace graphdrl {

// Each as likely as any other. Grids up to `largest` cells a side, graphs up to seven times as many nodes.
std::vector<WorldSpec> training_worlds(int largest);

}  // namespace graphdrl
