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

}  // namespace
}  // namespace graphdrl
