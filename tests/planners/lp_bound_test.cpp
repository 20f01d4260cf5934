// Bounds and walks of branch and cut beside brute force, on thousands of small random worlds of every kind.
#include "graphdrl/planners/bound.h"

#include <gtest/gtest.h>
#include <optional>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/exact.h"
#include "support.h"

namespace graphdrl {
namespace {

// Sparse and dense, directed or not, with and without costs, prizes, blocked nodes, an end, nodes visited before and
// nodes that others have claimed. Empty where the end is out of reach.
std::optional<Task> random_task(Rng& rng) {
  const auto nodes = static_cast<NodeId>(1 + rng.below(10));
  const auto any_node = [&] { return static_cast<NodeId>(rng.below(static_cast<std::uint32_t>(nodes))); };
  const bool directed = rng.below(2) == 0;
  const std::uint32_t weights = rng.below(3);
  std::vector<Edge> edges;
  for (std::uint32_t i = rng.below(static_cast<std::uint32_t>(2 * nodes)); i > 0; --i) {
    edges.push_back({any_node(), any_node(), weights == 0 ? 1 : weights == 1 ? 0.25 * rng.below(12) : rng.uniform()});
  }
  if (!directed && rng.below(2) == 0) {  // connected
    for (NodeId node = 1; node < nodes; ++node) edges.push_back({node - 1, node, weights == 2 ? rng.uniform() : 1});
  }
  std::vector<bool> blocked(nodes);
  for (NodeId node = 1; node < nodes; ++node) blocked[node] = rng.below(8) == 0;
  std::vector<double> prizes;
  const std::uint32_t kind = rng.below(3);
  for (NodeId node = 0; node < nodes && kind > 0; ++node) {
    prizes.push_back(kind == 1 ? 0.5 * rng.below(7) : rng.uniform());
  }
  World world("random", Graph::from_edges(nodes, edges, directed ? EdgeKind::kDirected : EdgeKind::kUndirected),
              blocked, {}, prizes);
  const NodeId start = world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
  const double budget = (weights == 2 ? 0.25 : 0.5) * rng.below(28);
  const std::uint32_t end_kind = rng.below(4);
  End end = End::anywhere();
  if (end_kind == 0) end = End::at_start();
  if (end_kind == 1) end = End::at(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
  const auto draw_set = [&](bool with_start) {
    NodeSet set(nodes);
    if (with_start) set.insert(start);
    for (const NodeId node : world.valid_nodes()) {
      if (rng.below(3) == 0) set.insert(node);
    }
    return set;
  };
  try {
    Task task(world, start, budget, end);
    if (rng.below(4) == 0) task = task.rest(start, budget, draw_set(true));
    if (rng.below(4) == 0) task = task.without(draw_set(false));
    return task;
  } catch (const Error&) {
    return std::nullopt;
  }
}

TEST(LpBound, IsTheOptimumOnRandomWorlds) {
  if (!has_lp_bound()) GTEST_SKIP() << "built without CLP";
  Rng rng(21);
  int compared = 0;
  int tight = 0;
  int tight_before = 0;
  for (int i = 0; i < 10'000; ++i) {
    SCOPED_TRACE(i);
    const std::optional<Task> drawn = random_task(rng);
    if (!drawn) continue;
    const Task& task = *drawn;
    ++compared;
    const auto walk = exact_walk(task);
    ASSERT_TRUE(walk);
    const double optimum = plan_of_walk(task, *walk).prize;
    const double quick = max_prize(task);
    tight_before += quick <= optimum * (1 + 1e-9);
    const auto lp = make_lp_bound(task, kNoLimit);
    lp->cut(0, {});
    ASSERT_GE(lp->bound(), optimum * (1 - kPrizeRounding));
    tight += std::min(lp->bound(), quick) <= optimum * (1 + 1e-9);
    // From nothing, from something worse, or from the best.
    const double known = std::vector<double>{0, NearestPlanner().plan(task).prize, optimum}[rng.below(3)];
    lp->branch(known, {});
    ASSERT_NEAR(lp->bound(), optimum, 1e-8);
    if (known >= optimum * (1 - 1e-9)) continue;
    ASSERT_FALSE(lp->walk().empty());
    const Plan found = plan_of_walk(task, lp->walk());
    ASSERT_LE(found.cost, task.limit());
    ASSERT_NEAR(found.prize, optimum, 1e-8);
    ASSERT_TRUE(task.ends_anywhere() || found.walk.back() == task.end());
    Plan plan = NearestPlanner().plan(task);
    improve(*lp, task, plan);
    ASSERT_TRUE(plan.optimal);
  }
  EXPECT_GT(compared, 8'000);
  EXPECT_GT(tight, tight_before + (compared - tight_before) / 2) << "the root is loose";
  RecordProperty("tight", tight);
}

// A star: the start in the middle, a leaf for each prize.
World star(const std::vector<double>& prizes_of_leaves) {
  std::vector<Edge> edges;
  std::vector<double> prizes = {0};
  for (const double prize : prizes_of_leaves) {
    edges.push_back({0, static_cast<NodeId>(prizes.size())});
    prizes.push_back(prize);
  }
  const auto nodes = static_cast<NodeId>(prizes.size());
  return World("star", Graph::from_edges(nodes, edges), std::vector<bool>(nodes), {}, prizes);
}

TEST(LpBound, TellsLargePrizesApart) {
  if (!has_lp_bound()) GTEST_SKIP() << "built without CLP";
  const World world = star({9e8, 9e8, 9e8, 10, 1});
  const auto lp = make_lp_bound(Task(world, 0, 7), kNoLimit);  // four leaves of five
  lp->branch(2.7e9 + 1, {});
  EXPECT_EQ(lp->bound(), 2.7e9 + 10);
  EXPECT_FALSE(lp->walk().empty());
}

TEST(LpBound, IsProvedWhereTheBudgetIsJustBelowAStep) {
  if (!has_lp_bound()) GTEST_SKIP() << "built without CLP";
  const World world = star({1, 1, 1, 1});
  const auto lp = make_lp_bound(Task(world, 0, 4.9999999), kNoLimit);
  lp->branch(0, {});
  EXPECT_EQ(lp->bound(), 2);
}

TEST(LpBound, ReachesTheSameInSlicesOfWork) {
  if (!has_lp_bound()) GTEST_SKIP() << "built without CLP";
  const World world = split_world({.family = "braided-maze", .size = 11}, Split::kTrain, 4);
  const Task task(world, world.valid_nodes().front(), 0.6 * world.valid_count());
  const auto whole = make_lp_bound(task, kNoLimit);
  whole->branch(0, {});
  const auto sliced = make_lp_bound(task, kNoLimit);
  double last = kNoLimit;
  int slices = 0;
  double found = 0;
  for (; slices < 1'000'000 && found < sliced->bound(); ++slices) {
    sliced->branch(0, {.work = 1e5});
    ASSERT_LE(sliced->bound(), last);
    last = sliced->bound();
    if (!sliced->walk().empty()) found = plan_of_walk(task, sliced->walk()).prize;
  }
  EXPECT_GT(slices, 3);
  EXPECT_EQ(sliced->bound(), whole->bound());
  EXPECT_EQ(found, whole->bound());
}

}  // namespace
}  // namespace graphdrl
