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
      for (const RolloutResult& result : roll_out(Episode(world, {.budget = 25}), world.valid_nodes(), *policy)) {
        walks.push_back(result.walk);
      }
      set_threads(1);
      if (count == 1) expected = walks;
      EXPECT_EQ(walks, expected) << name;
    }
  }
}

// The straight way home is dear.
class DearStraightWay final : public PairCosts {
 public:
  double cost(NodeId from, NodeId to) const override { return from + to == 2 && from != to ? 10 : 1; }
};

// Goes from 0 to 1 to 2 and stops.
class TwoSteps final : public Policy {
 public:
  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& /*clock*/) override {
    const Observation& now = observations[0];
    actions[0] = now.walk.size() == 3 ? kStop : now.action_to(now.position + 1);
  }
};

TEST(PlanBySteps, EndsByTheCheapestWay) {
  const World world("dear", Graph::complete(3, std::make_shared<DearStraightWay>()), std::vector<bool>(3));
  TwoSteps policy;
  const Plan plan =
      plan_by_steps(world, Task(world, 0, 4, End::at_start()), {.action_space = action_space_of(world)}, policy);
  EXPECT_EQ(plan.walk, (std::vector<NodeId>{0, 1, 2, 1, 0}));
  EXPECT_EQ(plan.cost, 4);
}

TEST(RollOut, EndsWhereMovesAreFree) {
  const std::vector<Edge> edges = {{0, 1, 0}, {1, 2, 0}, {2, 3, 7}};
  const World world("free", Graph::from_edges(4, edges), std::vector<bool>(4));
  const EpisodeOptions options{.budget = 3, .end = End::at_start(), .action_space = ActionSpace::kNeighbours};
  for (const char* name : {"random", "random-walk"}) {
    const auto policy = make_policy(name, 1);
    for (const RolloutResult& result : roll_out(Episode(world, options), world.valid_nodes(), *policy)) {
      EXPECT_LT(result.walk.size(), 200U) << name;
    }
    const Plan plan =
        plan_by_steps(world, Task(world, 0, 3, End::at_start()), {.action_space = action_space_of(world)}, *policy);
    EXPECT_EQ(plan.visited, 3) << name;
    EXPECT_EQ(plan.walk.back(), 0) << name;
  }
}

}  // namespace
}  // namespace graphdrl
