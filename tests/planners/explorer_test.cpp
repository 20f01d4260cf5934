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
    const Task task{.view = world, .start = world.valid_nodes()[0], .budget = 1.25 * world.valid_count()};
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
        const Plan plan =
            planner.plan({.view = world, .start = world.valid_nodes()[0], .budget = budget * world.valid_count()});
        EXPECT_EQ(plan.visited, world.valid_count()) << family << " " << index << " " << budget;
        EXPECT_LE(plan.cost, 2.0 * world.valid_count());
      }
    }
  }
}

// The next first visit may be farther off than the features look: here some 3000 steps back.
TEST(Explorer, GoesBackAsFarAsItMust) {
  const World world = grid_world(std::string(6001, '.') + "\n");
  ExplorerPlanner planner(std::make_shared<ExplorerScorer>(builtin_explorer()));
  EXPECT_EQ(planner.plan({.view = world, .start = 3000, .budget = 10'000}).visited, 6001);
}

TEST(Explorer, RefusesWeightsThatGiveNoNumbers) {
  Rng rng(1);
  auto parameters = std::make_shared<ExplorerParameters>(rng);
  for (float& value : parameters->values()) value *= 1e38f;
  const World world = grid_world("...\n...\n");
  ExplorerPlanner planner(std::make_shared<ExplorerScorer>(parameters));
  EXPECT_THROW(planner.plan({.view = world, .start = 0, .budget = 9}), Error);
}

struct Choices {
  int same = 0;  // as the first visit of the least shortfall
  int nearer = 0;
  int farther = 0;
  int indifferent = 0;  // not the least even with the cost counted in
};

// Walks through a world, a third of the time at random.
Choices compare_choices(const WorldSpec& spec) {
  const World world = split_world(spec, Split::kValidation, 0);
  ExplorerScorer scorer(builtin_explorer());
  Rng rng(2);
  NodeSet visited(world.node_count());
  ExplorationState state{.visited = visited,
                         .visited_count = 0,
                         .position = world.valid_nodes()[0],
                         .spendable = 1.0 * world.valid_count()};
  ExplorerBatch batch;
  std::vector<float> shortfall;
  Choices result;
  for (int i = 0; i < 200; ++i) {
    visited.insert(state.position);
    ++state.visited_count;
    batch.clear();
    const auto visits = scorer.encoder().append(world, state, kExplorerScope, batch);
    if (visits.empty()) break;
    scorer.shortfalls(batch, shortfall);
    const auto least =
        static_cast<std::size_t>(std::min_element(shortfall.begin(), shortfall.end()) - shortfall.begin());
    const std::size_t choice = scorer.choose(world, batch, visits);
    (choice == least ? result.same : visits[choice].cost <= visits[least].cost ? result.nearer : result.farther) += 1;
    const double plenty = std::clamp(0.1 * (batch.budget_per_work[0] - 1.2), 0.0, 1.0);
    const auto score = [&](std::size_t v) { return shortfall[v] + (0.5 * batch.unseen[0] + plenty) * visits[v].cost; };
    for (std::size_t v = 0; v < visits.size(); ++v) {
      if (score(v) >= score(choice) - 1e-4) continue;
      ++result.indifferent;
      EXPECT_LE(score(choice), score(v) + 0.4 * batch.unseen[0] * batch.unseen[0] + 1e-4);
      EXPECT_LE(visits[choice].cost, visits[v].cost);
    }
    const FirstVisit next = visits[rng.below(3) == 0 ? rng.below(static_cast<std::uint32_t>(visits.size())) : choice];
    state.position = next.node;
    state.spendable -= next.cost;
  }
  return result;
}

TEST(Explorer, TakesTheNetworksChoiceWhereItSeesAllTheWork) {
  const Choices choices = compare_choices({"obstacles", 8});
  EXPECT_GT(choices.same, 20);
  EXPECT_EQ(choices.nearer + choices.farther + choices.indifferent, 0);
}

TEST(Explorer, PrefersNearerFirstVisitsWhereMostWorkIsOutOfSight) {
  const Choices choices = compare_choices({"obstacles", 30});
  EXPECT_GT(choices.same, 20);
  EXPECT_GT(choices.nearer, 20);
  EXPECT_EQ(choices.farther, 0);
  EXPECT_GT(choices.indifferent, 20);
}

}  // namespace
}  // namespace graphdrl
