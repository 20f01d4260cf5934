#include "graphdrl/planners/exact.h"

#include <gmock/gmock.h>

#include <set>

#include "graphdrl/env/episode.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/planner_policy.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

// The best of all walks, each tried: most nodes, then fewest steps, then lexicographically first.
struct BruteForce {
  const World& world;
  std::vector<NodeId> walk = {};
  std::vector<NodeId> best = {};
  int best_count = 0;

  void search(int budget) {
    const int count = static_cast<int>(std::set(walk.begin(), walk.end()).size());
    if (count > best_count || (count == best_count && walk.size() < best.size()) ||
        (count == best_count && walk.size() == best.size() && walk < best)) {
      best = walk;
      best_count = count;
    }
    if (budget == 0) return;
    for (const NodeId next : world.open_neighbours(walk.back())) {
      walk.push_back(next);
      search(budget - 1);
      walk.pop_back();
    }
  }
};

TEST(ExactSearch, IsBruteForceOnSmallWorlds) {
  Rng rng(1);
  for (int round = 0; round < 150; ++round) {
    const World world = random_world(rng, 3, 3, 0.25);
    const int budget = static_cast<int>(rng.below(10));
    const NodeId start = world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
    BruteForce brute{.world = world, .walk = {start}};
    brute.search(budget);
    const Task from(world, start, static_cast<double>(budget));
    EXPECT_EQ(exact_walk(from), brute.best);
    EXPECT_EQ(exact_prize(from), brute.best_count);
  }
}

TEST(ExactSearch, SolvesAnOpenGridOfTwentyFiveNodes) {
  const World world = grid_world(".....\n.....\n.....\n.....\n.....\n");
  EXPECT_EQ(exact_prize(Task(world, 0, 24)), 25);
  EXPECT_EQ(exact_prize(Task(world, 1, 24)), 24);  // the lesser colour of the chessboard cannot
  EXPECT_EQ(exact_prize(Task(world, 1, 25)), 25);
  EXPECT_EQ(exact_prize(Task(world, 12, 1.5)), 2);
}

TEST(ExactSearch, CountsOnlyWhatItCanReach) {
  const World world = grid_world("..#..\n..#..\n");
  EXPECT_EQ(exact_prize(Task(world, 0, 25)), 4);
  EXPECT_EQ(exact_prize(Task(world, 0, 0)), 1);
}

TEST(ExactSearch, SaysWhenItIsOutOfReach) {
  const World world = grid_world(std::string(65, '.') + "\n");
  EXPECT_EQ(exact_prize(Task(world, 0, 100)), std::nullopt);
  const World large = grid_world(std::string(5'000, '.') + "\n");
  Episode episode(large, {.budget = 100});
  episode.reset(0);
  const Observation observation = episode.observation();
  int action = 0;
  PlannerPolicy policy(std::make_unique<ExactPlanner>());
  EXPECT_THROW(policy.act({&observation, 1}, {&action, 1}), SearchOutOfReach);
}

TEST(PlannerPolicy, PlansAnewWhereSomeoneElseLedTheWay) {
  const World world = grid_world("....\n");
  PlannerPolicy policy(std::make_unique<ExactPlanner>());
  const NodeId start = 1;
  EXPECT_THAT(roll_out(Episode(world, {.budget = 4}), {&start, 1}, policy).front().walk, ElementsAre(1, 0, 1, 2, 3));
  Episode episode(world, {.budget = 4});
  follow_walk(episode, std::vector<NodeId>{1, 2});
  const Observation observation = episode.observation();
  int action = 0;
  policy.act({&observation, 1}, {&action, 1});
  EXPECT_EQ(action, 2);  // on to the right: going back would leave node 3 out
}

}  // namespace
}  // namespace graphdrl
