#include "graphdrl/eval/rollout.h"

#include <gtest/gtest.h>

#include "graphdrl/base/parallel.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(RollOut, GivesTheSameWalksForAnyNumberOfThreads) {
  const World world = grid_world(
      ".....\n"
      ".#.#.\n"
      ".....\n"
      ".#.#.\n"
      "..#..\n");
  for (const char* name : {"random", "beam:4", "explorer", "guided:4"}) {
    std::vector<std::vector<NodeId>> expected;
    for (const int count : {1, 2, 3}) {
      set_threads(count);
      const auto policy = make_policy(name, 1);
      std::vector<std::vector<NodeId>> walks;
      for (const RolloutResult& result : roll_out(world, world.valid_nodes(), {.budget = 25}, *policy)) {
        walks.push_back(result.walk);
      }
      set_threads(1);
      if (count == 1) expected = walks;
      EXPECT_EQ(walks, expected) << name;
    }
  }
}

TEST(RollOut, EndsWhereMovesAreFree) {
  const std::vector<Edge> edges = {{0, 1, 0}, {1, 2, 0}, {2, 3, 7}};
  const World world("free", Graph::from_edges(4, edges), std::vector<bool>(4));
  const EpisodeOptions options{.budget = 3, .end = End::at_start(), .action_space = ActionSpace::kNeighbours};
  for (const char* name : {"random", "random-walk"}) {
    const auto policy = make_policy(name, 1);
    for (const RolloutResult& result : roll_out(world, world.valid_nodes(), options, *policy)) {
      EXPECT_LT(result.walk.size(), 200U) << name;
    }
    const Task task{.view = world, .start = 0, .budget = 3, .end = 0};
    const Plan plan = plan_by_steps(world, task, *policy, {}, {});
    EXPECT_EQ(plan.visited, 3) << name;
    EXPECT_EQ(plan.walk.back(), 0) << name;
  }
}

}  // namespace
}  // namespace graphdrl
