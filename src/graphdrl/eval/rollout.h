// Walks whole episodes with a policy.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

struct RolloutResult {
  std::vector<NodeId> walk;  // the start first, in the world's numbers
  double prize;
  double cost;
};

// How many episodes to walk side by side: as many as a network takes at once with profit, and fewer where their visit
// counts would fill the memory.
int block_size(const World& world);

// One episode like `episode` per start, side by side, each until it is done, the policy stops or the clock passes.
// places: of the starts among all episodes, 0, 1, 2 … where there are none: the numbers of unknown nodes depend on
// them.
std::vector<RolloutResult> roll_out(const Episode& episode, std::span<const NodeId> starts, Policy& policy,
                                    const Clock& clock = {}, std::span<const int> places = {});

// How a world became known on a walk.
struct Discovered {
  std::vector<NodeId> nodes;    // in the order in which they were seen
  std::vector<int> after_step;  // [steps + 1], how many of them were seen by then
  int no_way_back = 0;          // seen and left, since no way from there to where the walk must end is known
};

// Lets a policy that chooses step by step walk one episode, and takes that for its plan, up to the last gain where it
// may end anywhere. Once the clock passes, goes straight to where it must end. options: budget and end are the task's.
// think_s: seconds for a choice. discovered: of an unknown world, how it became known.
Plan plan_by_steps(const World& world, const Task& task, const EpisodeOptions& options, Policy& policy,
                   const Clock& clock = {}, double think_s = kNoLimit, Discovered* discovered = nullptr);

}  // namespace graphdrl
