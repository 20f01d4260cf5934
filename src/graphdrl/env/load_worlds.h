// Worlds and starts as users name them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/world.h"

namespace graphdrl {

// Every map of every source, as load_maps takes them. Throws Error.
std::vector<World> load_worlds(const std::vector<std::string>& sources);

// The one map of a source. Throws Error where it holds more.
World load_one_world(const std::string& source);

// A start: a node's label, a node id, or "row,col" on a grid. Throws Error where it is no valid node of the world.
NodeId parse_start(const World& world, std::string_view text);

}  // namespace graphdrl
