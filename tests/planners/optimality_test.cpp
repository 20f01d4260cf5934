// Plans, optima and bounds against brute force, on thousands of small random worlds of every kind.
#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <map>
#include <queue>

#include "graphdrl/env/walk.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/exact.h"
#include "graphdrl/planners/registry.h"
#include "support.h"

namespace graphdrl {
namespace {

struct Case {
  World world;
  NodeId start;
  double budget;
};

// Sparse and dense, undirected and directed, with and without costs and blocked nodes, connected or not.
Case random_case(Rng& rng) {
  const auto nodes = static_cast<NodeId>(1 + rng.below(8));
  const bool directed = rng.below(2) == 0;
  const bool weighted = rng.below(2) == 0;
  const auto edge_count = rng.below(static_cast<std::uint32_t>(2 * nodes));
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i < edge_count; ++i) {
    const auto end = [&] { return static_cast<NodeId>(rng.below(static_cast<std::uint32_t>(nodes))); };
    edges.push_back({end(), end(), weighted ? 0.25 * (1 + rng.below(12)) : 1.0});
  }
  std::vector<bool> blocked(nodes);
  for (NodeId node = 1; node < nodes; ++node) blocked[node] = rng.below(6) == 0;
  World world("random", Graph::from_edges(nodes, edges, directed ? EdgeKind::kDirected : EdgeKind::kUndirected),
              blocked);
  const NodeId start = world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
  return {std::move(world), start, 0.5 * rng.below(28)};
}

struct Optimum {
  int visited;
  double cost;  // of the cheapest walk that visits so many
};

// The least cost of every pair of visited set and position, step by step.
Optimum brute_force(const Case& c) {
  using Key = std::pair<unsigned, NodeId>;
  std::map<Key, double> least;
  std::priority_queue<std::pair<double, Key>, std::vector<std::pair<double, Key>>, std::greater<>> queue;
  queue.push({0, {1U << c.start, c.start}});
  Optimum best{.visited = 0, .cost = 0};
  while (!queue.empty()) {
    const auto [cost, key] = queue.top();
    queue.pop();
    if (!least.try_emplace(key, cost).second) continue;
    const int visited = std::popcount(key.first);
    if (visited > best.visited) best = {visited, cost};
    const Graph& graph = c.world.graph();
    for (int i = 0; i < graph.degree(key.second); ++i) {
      const NodeId next = graph.neighbours(key.second)[i];
      const double after = cost + graph.cost(key.second, i);
      if (!c.world.is_blocked(next) && after <= c.budget) queue.push({after, {key.first | 1U << next, next}});
    }
  }
  return best;
}

TEST(Optimality, PlansOptimaAndBoundsHoldOnRandomWorlds) {
  Rng rng(11);
  int tight = 0;
  constexpr int kCases = 10'000;
  for (int i = 0; i < kCases; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const SearchStart start = search_start(c.world, c.start, c.budget);
    const Optimum optimum = brute_force(c);
    const int most = max_visited(start);
    ASSERT_GE(most, optimum.visited);
    tight += most == optimum.visited;

    const auto follow = [&](const std::vector<NodeId>& walk) {
      Episode episode(c.world, {.budget = c.budget, .action_space = ActionSpace::kNeighbours});
      follow_walk(episode, walk);  // throws where a step is no edge or cannot be paid for
      return Optimum{episode.visited_count(), episode.spent()};
    };
    const auto exact = exact_walk(start);
    ASSERT_TRUE(exact);
    const Optimum found = follow(*exact);
    ASSERT_EQ(found.visited, optimum.visited);
    ASSERT_NEAR(found.cost, optimum.cost, 1e-9);
    ASSERT_EQ(exact_gain(start), optimum.visited - 1);
    for (const int width : {1, 3}) ASSERT_LE(follow(beam_plan(start, {.width = width})->walk).visited, optimum.visited);
    const auto complete = beam_plan(start, {.width = 1000});  // no partial walk is dropped
    ASSERT_TRUE(complete->optimal);
    const Optimum all = follow(complete->walk);
    ASSERT_EQ(all.visited, optimum.visited);
    ASSERT_NEAR(all.cost, optimum.cost, 1e-9);
    ExplorerGuide guide(builtin_explorer());
    const auto guided = beam_plan(start, {.width = 1000}, {}, &guide);
    ASSERT_TRUE(guided->optimal);
    ASSERT_EQ(follow(guided->walk).visited, optimum.visited);
    const auto narrow = beam_plan(start, {.width = 1}, {}, &guide);
    ASSERT_TRUE(!narrow->optimal || follow(narrow->walk).visited == optimum.visited);
    const Plan alone = ExplorerPolicy(builtin_explorer()).plan(start);
    ASSERT_TRUE(!alone.optimal || follow(alone.walk).visited == optimum.visited);
    for (const char* const name :
         {"random", "random-walk", "dfs", "nearest", "beam:2", "explorer", "guided:2", "exact"}) {
      const auto policy = make_policy(name, 1);
      const EpisodeOptions options{.budget = c.budget, .action_space = ActionSpace::kNeighbours};
      const RolloutResult result = roll_out(c.world, std::span(&c.start, 1), options, *policy).front();
      ASSERT_LE(follow(result.walk).visited, optimum.visited) << name;
    }
  }
  EXPECT_GT(tight, kCases * 9 / 10) << "the bound is loose";
}

TEST(Beam, ClaimsNoOptimumWhereItDidNotLookAtEverything) {
  std::vector<Edge> rays;
  for (NodeId leaf = 1; leaf <= 200; ++leaf) rays.push_back({0, leaf});
  const World star("star", Graph::from_edges(201, rays), std::vector<bool>(201));
  const SearchStart start = search_start(star, 0, 1);
  ExplorerGuide guide(builtin_explorer());
  EXPECT_FALSE(beam_plan(start, {.width = 1000}, {}, &guide)->optimal);
  EXPECT_FALSE(ExplorerPolicy(builtin_explorer()).plan(start).optimal);
  EXPECT_TRUE(beam_plan(start, {.width = 1000})->optimal) << "all leaves are as near as the sixteenth";
  EXPECT_FALSE(beam_plan(start, {.width = 1000, .cut_ties = true})->optimal);
  // One way out of 200, each longer than the last.
  for (Edge& ray : rays) ray.cost = ray.b;
  const World longer("longer", Graph::from_edges(201, rays, EdgeKind::kDirected), std::vector<bool>(201));
  const SearchStart far = search_start(longer, 0, 200);
  EXPECT_FALSE(beam_plan(far, {.width = 1000})->optimal);
  EXPECT_TRUE(beam_plan(far, {.width = 1000, .branching = 200})->optimal);
}

TEST(Beam, TakesTheLongWayPastManyLeavesWhereTheBudgetIsShort) {
  // A hub with leaves, each of which costs two steps, and a path, each node of which costs one. Whatever the numbering,
  // the path is among the first visits looked at, and the rank without penalties prefers it.
  constexpr NodeId kNodes = 100;
  for (const NodeId leaves : {10, 40}) {
    for (const bool path_first : {false, true}) {
      std::vector<Edge> edges;
      for (NodeId i = 1; i < kNodes; ++i) {
        const bool on_path = path_first ? i < kNodes - leaves : i > leaves;
        const bool first = path_first ? i == 1 : i == leaves + 1;
        edges.push_back({on_path && !first ? i - 1 : 0, i});
      }
      const World world("hub", Graph::from_edges(kNodes, edges), std::vector<bool>(kNodes));
      const SearchStart start = search_start(world, 0, 40);
      EXPECT_EQ(visited_after(start, beam_plan(start, {})->walk), 41) << leaves << path_first;
    }
  }
}

TEST(Optimality, PlansGoOnFromWhereSomeoneElseLed) {
  Rng rng(12);
  for (int i = 0; i < 500; ++i) {
    const Case c = random_case(rng);
    SearchStart start = search_start(c.world, c.start, c.budget);
    for (const NodeId node : c.world.valid_nodes()) {
      if (rng.below(3) == 0) start.visited[node] = true;
    }
    const auto exact = exact_walk(start);
    ASSERT_TRUE(exact);
    ASSERT_GE(max_visited(start), visited_after(start, *exact));
    ASSERT_LE(visited_after(start, beam_plan(start, {})->walk), visited_after(start, *exact));
    ASSERT_LE(walk_cost(c.world, *exact), c.budget + 1e-9);
  }
}

TEST(Bound, IsWorkedOutByHand) {
  // A star of four leaves: each leaf but the last is paid twice.
  const std::vector<Edge> star = {{0, 1}, {0, 2}, {0, 3}, {0, 4}};
  const World world("star", Graph::from_edges(5, star), std::vector<bool>(5));
  const auto bound = [&](NodeId start, double budget) { return max_visited(search_start(world, start, budget)); };
  EXPECT_EQ(bound(0, 0), 1);
  EXPECT_EQ(bound(0, 3), 3);
  EXPECT_EQ(bound(0, 6), 4);
  EXPECT_EQ(bound(0, 7), 5);
  EXPECT_EQ(bound(1, 6), 5);
  EXPECT_EQ(bound(1, 5), 4);
  // A one-way street of three nodes with a side street at the start: what was left is lost.
  const std::vector<Edge> street = {{0, 1}, {1, 2}, {0, 3}};
  const World one_way("street", Graph::from_edges(4, street, EdgeKind::kDirected), std::vector<bool>(4));
  EXPECT_EQ(max_visited(search_start(one_way, 0, 100)), 3);
  EXPECT_EQ(max_visited(search_start(one_way, 2, 100)), 1);
  // Two ways that meet: no walk takes both.
  const std::vector<Edge> ways = {{0, 1}, {0, 2}, {1, 3}, {2, 3}};
  const World meeting("ways", Graph::from_edges(4, ways, EdgeKind::kDirected), std::vector<bool>(4));
  EXPECT_EQ(max_visited(search_start(meeting, 0, 100)), 3);
  // A checkerboard's colours alternate: of 3 × 3 cells, eight steps from one of the four have at most eight.
  const World board = grid_world("...\n...\n...\n");
  EXPECT_EQ(max_visited(search_start(board, 1, 8)), 8);
  EXPECT_EQ(max_visited(search_start(board, 0, 8)), 9);
}

TEST(SpendingLimit, IsOneRuleForEpisodesSearchesAndBounds) {
  // 1000.0000005 of 1000 is within the rounding of sums, whoever adds up; two tiny edges of nothing are not.
  const std::vector<Edge> close = {{0, 1, 999}, {1, 2, 1.0000005}};
  const World path("path", Graph::from_edges(3, close), std::vector<bool>(3));
  const std::vector<Edge> tiny = {{0, 1, 1e-10}, {1, 2, 1e-10}};
  const World atoms("atoms", Graph::from_edges(3, tiny), std::vector<bool>(3));
  struct Expected {
    const World* world;
    double budget;
    int visited;
  };
  for (const auto& [world, budget, visited] :
       {Expected{&path, 1000, 3}, Expected{&path, 999.9, 2}, Expected{&atoms, 0, 1}, Expected{&atoms, 1e-10, 2}}) {
    const SearchStart start = search_start(*world, 0, budget);
    EXPECT_EQ(visited_after(start, *exact_walk(start)), visited);
    EXPECT_EQ(visited_after(start, beam_plan(start, {})->walk), visited);
    EXPECT_EQ(max_visited(start), visited);
    Episode episode(*world, {.budget = budget, .action_space = ActionSpace::kNeighbours});
    follow_walk(episode, *exact_walk(start));
    EXPECT_EQ(episode.visited_count(), visited);
  }
}

TEST(Beam, WithTimeWidensUntilNothingIsDropped) {
  const World world = grid_world("..#..\n.....\n#.#.#\n.....\n..#..\n");
  const auto ample = std::chrono::hours(1);
  int improved = 0;
  for (const NodeId node : world.valid_nodes()) {
    const SearchStart start = search_start(world, node, 20);
    const int optimum = 1 + *exact_gain(start);
    const Plan narrow = BeamPolicy({.width = 1, .branching = 1}).plan(start);
    improved += visited_after(start, narrow.walk) < optimum;
    const Plan wide = BeamPolicy({.width = 1, .branching = 1}, ample).plan(start);
    EXPECT_TRUE(wide.optimal);
    EXPECT_EQ(visited_after(start, wide.walk), optimum);
    const Plan exact = ExactPolicy(ample).plan(start);
    EXPECT_TRUE(exact.optimal);
    EXPECT_EQ(visited_after(start, exact.walk), optimum);
  }
  EXPECT_GT(improved, 0) << "a beam of one never goes astray here: the test shows nothing";
}

TEST(Beam, WithoutTimeKeepsItsFirstWalk) {
  const World world = grid_world("..#..\n.....\n#.#.#\n.....\n..#..\n");
  const SearchStart start = search_start(world, 0, 20);
  EXPECT_FALSE(beam_plan(start, {}, std::chrono::steady_clock::now()));
  const Plan narrow = BeamPolicy({.width = 1}, std::chrono::seconds(0)).plan(start);
  EXPECT_EQ(narrow.walk, BeamPolicy({.width = 1}).plan(start).walk);
}

TEST(Baselines, FollowOneWayStreetsAndCosts) {
  // 0 → 1 → 2 → 0, and a side street 1 → 3 → 1.
  const std::vector<Edge> edges = {{0, 1, 1}, {1, 2, 1}, {2, 0, 1}, {1, 3, 5}, {3, 1, 1}};
  const World world("streets", Graph::from_edges(4, edges, EdgeKind::kDirected), std::vector<bool>(4));
  const auto walk_of = [&](const char* name, double budget) {
    const NodeId start = 0;
    const EpisodeOptions options{.budget = budget, .action_space = ActionSpace::kNeighbours};
    return roll_out(world, std::span(&start, 1), options, *make_policy(name, 1)).front().walk;
  };
  EXPECT_EQ(walk_of("dfs", 20), (std::vector<NodeId>{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(walk_of("nearest", 20), (std::vector<NodeId>{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(walk_of("nearest", 8), (std::vector<NodeId>{0, 1, 2, 0, 1})) << "the next step costs 5 of 4";
}

}  // namespace
}  // namespace graphdrl
