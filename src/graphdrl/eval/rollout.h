// Walks whole episodes with a policy.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

struct RolloutResult {
  std::vector<NodeId> walk;  // the start first
  double prize;
};

// How many episodes to walk side by side: as many as a network takes at once with profit, and fewer where their visit
// counts would fill the memory.
int block_size(const World& world);

// One episode like `episode` per start, side by side, each until it is done, the policy stops or the clock passes.
std::vector<RolloutResult> roll_out(const Episode& episode, std::span<const NodeId> starts, Policy& policy,
                                    const Clock& clock = {});

// Lets a policy that chooses step by step walk one episode, and takes that for its plan, up to the last first visit
// where it may end anywhere. Once the clock passes, goes straight to where it must end.
Plan plan_by_steps(const World& world, const Task& task, Policy& policy, const Clock& clock = {});

}  // namespace graphdrl
