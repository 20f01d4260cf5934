#include "graphdrl/planners/explorer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/planners/beam.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(Explorer, GuidesABeamToMoreThanItFindsAlone) {
  int gain = 0;
  for (int index = 0; index < 30; ++index) {
    const World world = split_world({"loop-maze", 11}, Split::kValidation, index);
    ExplorerScorer scorer(builtin_explorer());
    const Task task(world, world.valid_nodes()[0], 1.25 * world.valid_count());
    gain += beam_plan(task, {.width = 16}, {}, &scorer).visited - beam_plan(task, {.width = 16}).visited;
  }
  EXPECT_GE(gain, 30);  // of some 2200 nodes
}

// The network alone, which was trained on budgets up to 1.7x, would stray.
TEST(Explorer, VisitsAllWhereTheBudgetIsPlenty) {
  ExplorerPlanner planner(std::make_shared<ExplorerScorer>(builtin_explorer()));
  for (const char* const family : {"loop-maze", "obstacles"}) {
    for (int index = 0; index < 5; ++index) {
      const World world = split_world({family, 11}, Split::kValidation, index);
      for (const double budget : {2.0, 20.0}) {
        const Plan plan = planner.plan(Task(world, world.valid_nodes()[0], budget * world.valid_count()));
        EXPECT_EQ(plan.visited, world.valid_count()) << family << " " << index << " " << budget;
        EXPECT_LE(plan.cost, 2.0 * world.valid_count());
      }
    }
  }
}

// The next first visit may be farther off than the features look: here some 3000 steps back.
TEST(Explorer, GoesBackAsFarAsItMust) {
  const World world = grid_world(std::string(3001, '.') + "\n");
  ExplorerPlanner planner(std::make_shared<ExplorerScorer>(builtin_explorer()));
  EXPECT_EQ(planner.plan(Task(world, 1500, 5'000)).visited, 3001);
}

TEST(Explorer, RefusesWeightsThatGiveNoNumbers) {
  Rng rng(1);
  auto parameters = std::make_shared<ExplorerParameters>(rng);
  for (float& value : parameters->values()) value *= 1e38f;
  const World world = grid_world("...\n...\n");
  ExplorerPlanner planner(std::make_shared<ExplorerScorer>(parameters));
  EXPECT_THROW(planner.plan(Task(world, 0, 9)), Error);
}

// Walks at random through a world whose nodes have prizes or not. Gives how many states had most work out of scope.
int check_choices(const World& world) {
  int unseen = 0;
  ExplorerScorer scorer(builtin_explorer());
  Rng rng(2);
  const Task task(world, world.valid_nodes()[0], world.valid_count());
  NodeSet ground = task.ground();
  Exploration state(task, ground);
  const double mean_prize = world.total_prize() / world.valid_count();
  ExplorerBatch batch;
  ExplorerScratch scratch;
  std::vector<float> shortfall;
  int states = 0;
  for (;; ++states) {
    batch.clear();
    const auto visits = encode(state, scratch, batch).visits;
    if (visits.empty()) break;
    scorer.shortfalls(batch, shortfall);
    const auto score = [&](std::size_t v) {
      return shortfall[v] - (world.has_prizes() ? world.prize(visits[v].node) / mean_prize : 0) +
             0.5 * batch.unseen[0] * visits[v].cost;
    };
    const std::size_t choice = scorer.choose(task, batch, visits);
    double least = score(0);
    for (std::size_t v = 1; v < visits.size(); ++v) least = std::min(least, score(v));
    const double indifference = 0.8 * batch.unseen[0] * batch.unseen[0];
    unseen += batch.unseen[0] > 0.5;
    EXPECT_LE(score(choice), least + indifference + 1e-4);
    for (std::size_t v = 0; v < choice; ++v) EXPECT_GT(score(v), least + indifference - 1e-4) << "nearer";
    state.make(visits[rng.below(static_cast<std::uint32_t>(visits.size()))], ground);
  }
  EXPECT_GT(states, 10);
  return unseen;
}

TEST(Explorer, TakesTheFirstVisitThatTheNetworkPrefers) {
  EXPECT_EQ(check_choices(split_world({"obstacles", 8}, Split::kValidation, 0)), 0);
}

TEST(Explorer, PrefersNearerFirstVisitsWhereMostWorkIsOutOfSight) {
  EXPECT_GT(check_choices(split_world({"obstacles", 30}, Split::kValidation, 0)), 10);
}

TEST(Explorer, CountsThePrizeOfAFirstVisit) {
  const World plain = split_world({"obstacles", 8}, Split::kValidation, 0);
  Rng rng(3);
  std::vector<double> prizes;
  for (NodeId node = 0; node < plain.node_count(); ++node) prizes.push_back(rng.below(7));
  check_choices(World("prizes", plain.graph(), plain.blocked(), {}, prizes));
}

}  // namespace
}  // namespace graphdrl
