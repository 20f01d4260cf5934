#include "graphdrl/planners/online_explorer.h"

#include <gtest/gtest.h>

#include "graphdrl/env/world_families.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

// Share of a hidden world's nodes that are visited with as many steps, in %.
double coverage(const World& world, const std::string& name, std::uint64_t seed) {
  const NodeId start = world.valid_nodes()[seed % world.valid_nodes().size()];
  const Task task(world, start, world.valid_count() * world.open().mean_cost());
  const Episode episode(
      world, task, {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges"), .numbers_seed = seed});
  const auto policy = make_online_policy(parse_policy(name), seed);
  return world.percent_of_all(roll_out(episode, {&start, 1}, *policy).front().prize);
}

double mean_coverage(const WorldSpec& spec, const std::string& name) {
  constexpr int kWorlds = 20;
  double sum = 0;
  for (int i = 0; i < kWorlds; ++i) {
    Rng rng(1000 + i);
    World world = random_world(spec, rng);
    if (world.has_cells()) world = World(world.name(), world.to_map());  // no directions
    sum += coverage(world, name, i);
  }
  return sum / kWorlds;
}

// `pocket` is best of the rules on the one, `open` on the other; the explorer has to tell which it is on. It falls some
// five points behind where it takes the other's choices.
TEST(BuiltinOnlineExplorer, TellsWorldsApart) {
  const WorldSpec grid = {.family = "obstacles", .size = 12, .blocked = 0.0};
  EXPECT_GT(mean_coverage(grid, "explorer"), mean_coverage(grid, "open") + 4);
  const WorldSpec scale_free = {.family = "barabasi-albert-dense", .size = 150};
  EXPECT_GT(mean_coverage(scale_free, "explorer"), mean_coverage(scale_free, "pocket") + 4);
}

}  // namespace
}  // namespace graphdrl
