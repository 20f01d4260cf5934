#include "graphdrl/planners/explorer_policy.h"

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
    ExplorerGuide guide(builtin_explorer());
    const SearchStart start = search_start(world, world.valid_nodes()[0], 1.25 * world.valid_count());
    const auto visited = [&](ExplorerGuide* by) {
      return visited_after(start, beam_plan(start, {.width = 16}, {}, by)->walk);
    };
    gain += visited(&guide) - visited(nullptr);
  }
  EXPECT_GE(gain, 30);  // of some 2200 nodes
}

// The network alone, which was trained on budgets up to 1.7x, would stray.
TEST(Explorer, VisitsAllWhereTheBudgetIsPlenty) {
  for (const char* const family : {"loop-maze", "obstacles"}) {
    for (int index = 0; index < 5; ++index) {
      const World world = split_world({family, 11}, Split::kValidation, index);
      for (const double budget : {2.0, 20.0}) {
        const SearchStart start = search_start(world, world.valid_nodes()[0], budget * world.valid_count());
        const Plan plan = ExplorerPolicy(builtin_explorer()).plan(start);
        EXPECT_EQ(visited_after(start, plan.walk), world.valid_count()) << family << " " << index << " " << budget;
        EXPECT_LE(walk_cost(world, plan.walk), 2.0 * world.valid_count());
      }
    }
  }
}

TEST(Explorer, RefusesWeightsThatGiveNoNumbers) {
  Rng rng(1);
  auto parameters = std::make_shared<ExplorerParameters>(rng);
  for (float& value : parameters->values()) value *= 1e38f;
  const World world = grid_world("...\n...\n");
  EXPECT_THROW(ExplorerPolicy(parameters).plan(search_start(world, 0, 9)), Error);
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
  ExplorerGuide guide(builtin_explorer());
  ExplorerEncoder& encoder = guide.encoder_for(world);
  Rng rng(2);
  std::vector<std::uint64_t> visited((static_cast<std::size_t>(world.graph().node_count()) + 63) / 64);
  ExplorerState state{
      .visited = visited.data(), .position = world.valid_nodes()[0], .spendable = 1.0 * world.valid_count()};
  ExplorerBatch batch;
  std::vector<float> shortfall;
  Choices result;
  for (int i = 0; i < 200; ++i) {
    visited[state.position / 64] |= std::uint64_t{1} << (state.position % 64);
    batch.clear();
    const auto visits = encoder.append(state, kExplorerScope, batch);
    if (visits.empty()) break;
    guide.score(batch, shortfall);
    const auto least =
        static_cast<std::size_t>(std::min_element(shortfall.begin(), shortfall.end()) - shortfall.begin());
    const std::size_t choice = guide.choose(world, batch, visits);
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
