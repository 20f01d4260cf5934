#include "graphdrl/planners/baselines.h"

#include <gmock/gmock.h>

#include "graphdrl/env/walk.h"
#include "graphdrl/eval/rollout.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

std::vector<NodeId> walk_of(Policy& policy, const World& world, NodeId start, double budget,
                            ActionSpace space = ActionSpace::kDirections) {
  return roll_out(world, {&start, 1}, {.budget = budget, .action_space = space}, policy).front().walk;
}

TEST(DepthFirst, DescendsInGraphOrderAndBacktracks) {
  DepthFirstPolicy policy;
  // 0 1 2
  // # 4 #
  const World world = grid_world("...\n#.#\n");
  EXPECT_THAT(walk_of(policy, world, 1, 25), ElementsAre(1, 0, 1, 2, 1, 4, 1));  // left, right, down, and stops at home
  EXPECT_THAT(walk_of(policy, world, 1, 3), ElementsAre(1, 0, 1, 2));
}

TEST(DepthFirst, WalksOtherGraphsByAscendingId) {
  DepthFirstPolicy policy;
  const std::vector<Edge> edges = {{0, 3}, {0, 1}, {1, 2}};
  const World world("tree", Graph::from_edges(4, edges), std::vector<bool>(4));
  EXPECT_THAT(walk_of(policy, world, 0, 9, ActionSpace::kNeighbours), ElementsAre(0, 1, 2, 1, 0, 3, 0));
}

TEST(NearestUnvisited, TakesTheFirstOfTheNearestAndStopsWhenNothingIsLeft) {
  NearestUnvisitedPolicy policy;
  EXPECT_THAT(walk_of(policy, grid_world("...\n#.#\n"), 1, 25), ElementsAre(1, 0, 1, 2, 1, 4));
  EXPECT_THAT(walk_of(policy, grid_world("..#.\n"), 0, 25), ElementsAre(0, 1));  // the last node is out of reach
  EXPECT_THAT(walk_of(policy, grid_world("...\n...\n...\n"), 4, 25), ElementsAre(4, 3, 0, 1, 2, 5, 8, 7, 6));
}

TEST(RandomPolicies, DrawUniformly) {
  const World world = grid_world("...\n.#.\n...\n");
  Episode episode(world, {.budget = 25});
  episode.reset(1);  // left and right are open, up is off the map, down is blocked
  const Observation observation = episode.observation();
  RandomPolicy random(1);
  RandomWalkPolicy random_walk(1);
  std::array<int, 4> directions{};
  std::array<int, 4> steps{};
  for (int i = 0; i < 8'000; ++i) {
    int action = 0;
    random.act({&observation, 1}, {&action, 1});
    ++directions[action];
    random_walk.act({&observation, 1}, {&action, 1});
    ++steps[action];
  }
  for (const int count : directions) EXPECT_NEAR(count, 2'000, 200);
  EXPECT_NEAR(steps[0], 4'000, 300);
  EXPECT_NEAR(steps[2], 4'000, 300);
  EXPECT_EQ(steps[1] + steps[3], 0);
}

TEST(Policies, StopWhereThereIsNowhereToGo) {
  const World world = grid_world(".#\n#.\n");
  RandomWalkPolicy random_walk(1);
  DepthFirstPolicy dfs;
  NearestUnvisitedPolicy nearest;
  for (Policy* policy :
       {static_cast<Policy*>(&random_walk), static_cast<Policy*>(&dfs), static_cast<Policy*>(&nearest)}) {
    EXPECT_THAT(walk_of(*policy, world, 0, 25), ElementsAre(0));
  }
}

}  // namespace
}  // namespace graphdrl
