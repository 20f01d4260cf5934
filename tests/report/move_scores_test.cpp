#include "graphdrl/report/move_scores.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

// A round trip along a corridor: only moves that leave enough for the way home are possible.
TEST(MoveScores, KnowWhereTheWalkMustEnd) {
  const World world = grid_world(".....\n");
  const Task task(world, 0, 4, End::at_start());
  Answer answer{.world = world, .task = task, .policy = "any", .plan = plan_of_walk(task, {0, 1, 2, 1, 0})};
  const MoveScores scores = scores_along(answer, "explorer");
  ASSERT_EQ(scores.steps.size(), 5u);
  ASSERT_EQ(scores.steps[1].size(), 1u);
  EXPECT_EQ(scores.steps[1][0].node, 2);
  EXPECT_TRUE(scores.steps[2].empty()) << "node 3 is near, but home is too far from there";
}

}  // namespace
}  // namespace graphdrl
