// Walks given as node ids, as users write and planners return them.
#pragma once

#include <functional>
#include <span>

#include "graphdrl/env/episode.h"

namespace graphdrl {

// Leads a fresh episode along `walk`, the start first; a repeated node is a blocked move. Calls `at_node` at every one,
// the start included. Throws Error where a node is no valid node or not one step from the one before it, or the
// budget does not last.
void follow_walk(Episode& episode, std::span<const NodeId> walk,
                 const std::function<void(const Observation&)>& at_node = {});

}  // namespace graphdrl
