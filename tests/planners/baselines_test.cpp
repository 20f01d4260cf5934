#include "graphdrl/planners/baselines.h"

#include <gmock/gmock.h>

#include "graphdrl/env/episode.h"
#include "graphdrl/eval/rollout.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

std::vector<NodeId> walk_of(Planner& planner, const World& world, NodeId start, double budget) {
  return planner.plan(Task(world, start, budget)).walk;
}

TEST(DepthFirst, DescendsInGraphOrderAndBacktracks) {
  DepthFirstPlanner planner;
  // 0 1 2
  // # 4 #
  const World world = grid_world("...\n#.#\n");
  EXPECT_THAT(walk_of(planner, world, 1, 25), ElementsAre(1, 0, 1, 2, 1, 4));  // left, right, down
  EXPECT_THAT(walk_of(planner, world, 1, 3), ElementsAre(1, 0, 1, 2));
}

TEST(DepthFirst, WalksOtherGraphsByAscendingId) {
  DepthFirstPlanner planner;
  const std::vector<Edge> edges = {{0, 3}, {0, 1}, {1, 2}};
  const World world("tree", Graph::from_edges(4, edges), std::vector<bool>(4));
  EXPECT_THAT(walk_of(planner, world, 0, 9), ElementsAre(0, 1, 2, 1, 0, 3));
}

TEST(NearestUnvisited, TakesTheFirstOfTheNearestAndStopsWhenNothingIsLeft) {
  NearestPlanner planner;
  EXPECT_THAT(walk_of(planner, grid_world("...\n#.#\n"), 1, 25), ElementsAre(1, 0, 1, 2, 1, 4));
  EXPECT_THAT(walk_of(planner, grid_world("..#.\n"), 0, 25), ElementsAre(0, 1));  // the last node is out of reach
  EXPECT_THAT(walk_of(planner, grid_world("...\n...\n...\n"), 4, 25), ElementsAre(4, 3, 0, 1, 2, 5, 8, 7, 6));
}

TEST(RandomPolicies, DrawUniformly) {
  const World world = grid_world("...\n.#.\n...\n");
  Episode episode(world, {.budget = 25});
  episode.reset(1);  // left and right are open, up is off the map, down is blocked
  const Observation observation = episode.observation();
  RandomPolicy random(1, /*blocked_too=*/true);
  RandomPolicy random_walk(1, /*blocked_too=*/false);
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

TEST(Baselines, StopWhereThereIsNowhereToGo) {
  const World world = grid_world(".#\n#.\n");
  RandomPolicy random_walk(1, /*blocked_too=*/false);
  const NodeId start = 0;
  EXPECT_THAT(roll_out(Episode(world, {.budget = 25}), {&start, 1}, random_walk).front().walk, ElementsAre(0));
  DepthFirstPlanner dfs;
  NearestPlanner nearest;
  EXPECT_THAT(walk_of(dfs, world, 0, 25), ElementsAre(0));
  EXPECT_THAT(walk_of(nearest, world, 0, 25), ElementsAre(0));
}

// Whatever they draw, they keep what the way to the end costs.
TEST(RandomPolicies, EndWhereTheyMust) {
  Rng rng(3);
  for (int round = 0; round < 200; ++round) {
    const World world = random_world(rng, 4, 4, 0.2);
    const auto draw = [&] { return world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]; };
    const NodeId start = draw();
    const NodeId end = draw();
    const EpisodeOptions options{.budget = 12, .end = End::at(end)};
    if (costs_to(world.into(), end)[start] > 12) continue;
    RandomPolicy random(rng.next(), /*blocked_too=*/true);
    RandomPolicy random_walk(rng.next(), /*blocked_too=*/false);
    for (Policy* policy : {static_cast<Policy*>(&random), static_cast<Policy*>(&random_walk)}) {
      const std::vector<NodeId> walk = roll_out(Episode(world, options), {&start, 1}, *policy).front().walk;
      ASSERT_EQ(walk.back(), end);
      ASSERT_LE(walk.size(), 13u);
    }
  }
}

}  // namespace
}  // namespace graphdrl
