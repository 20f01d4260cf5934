#include "graphdrl/planners/believing_policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

// How many nodes a walk of an unknown world visits, from its first node.
int visited(const World& world, double budget, const World* old, std::string_view end = "anywhere") {
  const Task task(world, 0, budget, parse_end(world, end));
  EpisodeOptions options{.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges")};
  std::unique_ptr<Policy> policy;
  if (old == nullptr) {
    policy = make_online_policy(parse_policy("explorer"), 1);
  } else {
    options.believed = believe(*old, world);
    policy = make_believing_policy(parse_policy("search:200"), 1, options.believed);
  }
  const Plan plan = plan_by_steps(world, task, options, *policy);
  EXPECT_LE(plan.cost, budget);
  EXPECT_TRUE(task.ends_anywhere() || plan.walk.back() == task.end());
  return plan.visited;
}

World square(int side, double blocked, std::uint64_t seed) {
  Rng rng(seed);
  return random_world(rng, side, side, blocked);
}

World with_first_free(World world) {
  GridMap map = *world.map();
  map.blocked[0] = map.blocked[1] = false;
  return World("test", std::move(map));
}

TEST(BelievingPolicy, VisitsWhatThePlanDoesWhereTheOldMapIsTrue) {
  const World world = with_first_free(square(9, 0.2, 1));
  const Task task(world, 0, 60);
  const int known = make_planner("search:200")->plan(task).visited;
  EXPECT_GE(visited(world, 60, &world), known);
}

TEST(BelievingPolicy, IsBetterWithAnOldMapThatHasChangedALittle) {
  int with = 0;
  int without = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    const World old = with_first_free(square(8, 0.15, seed));
    GridMap map = *old.map();
    Rng rng(seed);
    for (int change = 0; change < 3; ++change) {
      const int cell = 2 + rng.index(static_cast<int>(map.blocked.size()) - 2);
      map.blocked[cell] = !map.blocked[cell];
    }
    const World world("test", std::move(map));
    with += visited(world, 50, &old);
    without += visited(world, 50, nullptr);
  }
  EXPECT_GT(with, 1.03 * without);
}

TEST(BelievingPolicy, GivesUpAnOldMapThatIsWrong) {
  int with = 0;
  int without = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    const World old = with_first_free(square(10, 0.4, 100 + seed));
    const World world = with_first_free(square(10, 0.1, seed));
    with += visited(world, 80, &old);
    without += visited(world, 80, nullptr);
  }
  EXPECT_GT(with, 0.9 * without);
}

TEST(BelievingPolicy, FollowsArcsCostsNodesThatAreNewAndWaysBack) {
  // The old map ends at c, has a way back from there that is gone, and takes a cheap way for a dear one.
  const std::vector<Edge> before = {{0, 1, 1}, {1, 2, 1}, {2, 0, 1}};
  const std::vector<Edge> now = {{0, 1, 1}, {1, 2, 5}, {1, 0, 1}, {2, 3, 1}, {3, 0, 1}};
  const World old("old", Graph::from_edges(3, before, EdgeKind::kDirected), std::vector<bool>(3), {"a", "b", "c"});
  const World world("new", Graph::from_edges(4, now, EdgeKind::kDirected), std::vector<bool>(4), {"a", "b", "c", "d"});
  EXPECT_EQ(visited(world, 20, &old), 4);
  EXPECT_EQ(visited(world, 5, &old), 2);
  EXPECT_EQ(visited(world, kNoLimit, &old, "start"), 1);  // no way back from b is known
  const World grid = grid_world("...\n...\n");
  EXPECT_EQ(visited(grid, kNoLimit, &grid, "start"), 6);
  EXPECT_THAT(error_of([&] { visited(grid, 6, &grid, "start"); }), ::testing::HasSubstr("ways back must be known"));
}

World path_of(const std::vector<Edge>& edges, const std::vector<std::string>& labels) {
  const auto count = static_cast<NodeId>(labels.size());
  return World("path", Graph::from_edges(count, edges), std::vector<bool>(labels.size()), labels);
}

TEST(BelievingPolicy, VisitsWhatIsNewBesideThePlan) {
  const World old = path_of({{0, 1}, {1, 2}}, {"a", "b", "c"});
  const World world = path_of({{0, 1}, {1, 2}, {1, 3}}, {"a", "b", "c", "d"});
  EXPECT_EQ(visited(world, kNoLimit, &old), 4);
}

TEST(BelievingPolicy, EndsWhereAskedOnceTheEndIsSeen) {
  const World world = path_of({{0, 1}, {1, 2}, {2, 3}}, {"a", "b", "c", "d"});
  const auto believed = believe(world, world);
  const Episode episode(
      world, Task(world, 0, kNoLimit, End::at(3)),
      {.action_space = ActionSpace::kNeighbours, .reveal = Reveal::parse("edges"), .believed = believed});
  const auto policy = make_believing_policy(parse_policy("search:100"), 1, believed);
  const NodeId start = 0;
  EXPECT_THAT(roll_out(episode, {&start, 1}, *policy).front().walk, ::testing::ElementsAre(0, 1, 2, 3));
}

TEST(Believe, PairsNodesByLabelOrNumber) {
  const World numbered("n", Graph::from_edges(3, std::vector<Edge>{{0, 1}, {1, 2}}), std::vector<bool>(3));
  const World labelled = path_of({{0, 1}, {0, 2}, {2, 3}}, {"0", "2", "1", "new"});
  EXPECT_THAT(believe(numbered, labelled)->node_of, ::testing::ElementsAre(0, 2, 1, kNoNode));
}

TEST(Believe, RefusesMapsOfAnotherKind) {
  const World grid = grid_world("..\n..\n");
  const World wide = grid_world("...\n...\n");
  const std::vector<Edge> edges = {{0, 1, 1}};
  const World labelled("l", Graph::from_edges(2, edges), std::vector<bool>(2), {"a", "b"});
  const World others("o", Graph::from_edges(2, edges), std::vector<bool>(2), {"c", "d"});
  const World arcs("r", Graph::from_edges(2, edges, EdgeKind::kDirected), std::vector<bool>(2), {"a", "b"});
  EXPECT_THAT(error_of([&] { believe(wide, grid); }), ::testing::HasSubstr("2×2 cells"));
  EXPECT_THAT(error_of([&] { believe(labelled, grid); }), ::testing::HasSubstr("another kind"));
  EXPECT_THAT(error_of([&] { believe(arcs, labelled); }), ::testing::HasSubstr("another kind"));
  EXPECT_THAT(error_of([&] { believe(others, labelled); }), ::testing::HasSubstr("other nodes"));
  EXPECT_THAT(error_of([&] { make_believing_policy(parse_policy("nearest"), 1, believe(grid, grid)); }),
              ::testing::HasSubstr("does not plan on an old map"));
}

}  // namespace
}  // namespace graphdrl
