#include "graphdrl/answer/answer.h"

#include <gtest/gtest.h>

#include "graphdrl/planners/bound.h"
#include "support.h"

namespace graphdrl {
namespace {

// Two squares that share a node, and a cell apart. The knapsack alone leaves a gap that `search` closes.
TEST(Judge, TakesBackNothingThatAPlanProved) {
  const World world = grid_world(
      ".....\n"
      ".#.#.\n"
      ".....\n"
      ".#.##\n"
      "...#.\n");
  for (int budget = 1; budget < 24; ++budget) {
    const Task task(world, 0, budget, End::at_start());
    const Answer planned = make_plan(world, task, {});
    Answer judged{.world = world, .task = task, .policy = "walk", .plan = plan_of_walk(task, planned.plan.walk)};
    judge(judged);
    EXPECT_TRUE(!planned.plan.optimal || judged.plan.optimal) << budget;
    EXPECT_LE(judged.plan.bound, planned.plan.bound) << budget;
    EXPECT_EQ(judged.unreachable, 1);
  }
}

}  // namespace
}  // namespace graphdrl
