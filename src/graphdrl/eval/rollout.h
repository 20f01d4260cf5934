// Walks whole episodes with a policy.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/policy.h"

namespace graphdrl {

struct RolloutResult {
  std::vector<NodeId> walk;  // the start first
  double coverage;           // of the valid nodes, a fraction
};

// One episode per start, walked side by side until each is done or its policy stops.
std::vector<RolloutResult> roll_out(const World& world, std::span<const NodeId> starts, const EpisodeOptions& options,
                                    Policy& policy);

}  // namespace graphdrl
