#include "graphdrl/live/edge_exploration.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "graphdrl/base/random.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// A random connected world, with loops and parallel edges. mixed: some edges of a directed one lead both ways.
World random_world(Rng& rng, int nodes, int edges, EdgeKind kind, int most_cost, bool mixed = false) {
  GraphMap map;
  Multigraph all;
  const auto join = [&](NodeId a, NodeId b) { all.edges.push_back({a, b, 1.0 + rng.index(most_cost)}); };
  for (NodeId node = 0; node < nodes; ++node) join(node, (node + 1) % nodes);
  for (int i = 0; i < edges; ++i) join(rng.index(nodes), rng.index(nodes));
  for (std::size_t i = 0; mixed && i < all.edges.size(); ++i) all.both_ways.push_back(rng.index(2) == 0);
  set_edges(map, nodes, std::move(all), kind);
  map.blocked.resize(nodes);
  return {"random", std::move(map)};
}

// Follows the edges of an answer, and gives how many there are and what they cost.
void expect_walk(const Answer& answer, const World& world, double reset_cost) {
  const EdgeWalk& walk = answer.edges->walk;
  const Multigraph all = all_edges(world);
  ASSERT_EQ(walk.nodes.size(), walk.edges.size() + 1);
  std::set<std::int64_t> different;
  double cost = 0;
  for (std::size_t i = 0; i < walk.edges.size(); ++i) {
    if (walk.edges[i] == EdgeWalk::kResetEdge) {
      EXPECT_EQ(walk.nodes[i + 1], walk.nodes.front());
      cost += reset_cost;
      continue;
    }
    const Edge& edge = all.edges[static_cast<std::size_t>(walk.edges[i])];
    const bool forth = edge.a == walk.nodes[i] && edge.b == walk.nodes[i + 1];
    const bool back = edge.b == walk.nodes[i] && edge.a == walk.nodes[i + 1];
    const bool leads_back = all.leads_back(static_cast<std::size_t>(walk.edges[i]));
    EXPECT_TRUE(forth || (back && (!world.open().directed() || leads_back)));
    different.insert(walk.edges[i]);
    cost += edge.cost;
  }
  EXPECT_EQ(answer.edges->walked, std::ssize(different));
  EXPECT_DOUBLE_EQ(walk.cost, cost);
  EXPECT_DOUBLE_EQ(answer.plan.cost, cost);
  EXPECT_LE(static_cast<double>(answer.edges->walked), answer.edges->bound);
  ASSERT_EQ(answer.discovered.after_step.size(), answer.plan.walk.size());
  EXPECT_EQ(answer.discovered.after_step.back(), std::ssize(answer.discovered.nodes));
}

TEST(ExploreEdges, WalksAllWithoutABudget) {
  Rng rng(1);
  for (const auto& [kind, mixed] : {std::pair(EdgeKind::kDirected, false), std::pair(EdgeKind::kDirected, true),
                                    std::pair(EdgeKind::kUndirected, false)}) {
    for (const std::string policy : {"", "nearest", "dfs", "search:500"}) {
      const World world = random_world(rng, 9, 15, kind, 3, mixed);
      const Answer answer = answer_task(world, Task(world, 2, kNoLimit),
                                        {.policy = policy, .reveal = Reveal::parse("edges"), .cover = Cover::kEdges});
      EXPECT_EQ(answer.edges->walked, 24) << policy;
      EXPECT_EQ(answer.edges->edges, 24);
      expect_walk(answer, world, 0);
    }
  }
}

TEST(ExploreEdges, KeepsToItsBudgetAndComesHome) {
  Rng rng(2);
  for (int round = 0; round < 40; ++round) {
    const bool directed = round % 2 == 0;
    const EdgeKind kind = directed ? EdgeKind::kDirected : EdgeKind::kUndirected;
    const World world = random_world(rng, 8, 12, kind, 4, directed && round % 4 == 0);
    const double budget = rng.index(40);
    PlanRequest request{.reveal = Reveal::parse("edges"), .cover = Cover::kEdges, .price_s = 1};
    if (directed) request.reset_cost = 2;
    const Answer answer = answer_task(world, Task(world, 0, budget, End::at_start()), request);
    expect_walk(answer, world, 2);
    EXPECT_LE(answer.plan.cost, budget);
    EXPECT_EQ(answer.edges->walk.nodes.back(), 0);
    EXPECT_GE(answer.known->prize, answer.edges->walked) << "knowing the map";
  }
}

TEST(ExploreEdges, MayHaveAnyLabels) {
  GraphMap map;
  set_edges(map, 4,
            {.edges = {{0, 1}, {0, 2}, {0, 3}, {1, 0}, {2, 0}, {3, 0}}, .labels = {"x", "x#2", "x", "", "", "y"}},
            EdgeKind::kDirected);
  map.blocked.resize(4);
  const World world("labels", std::move(map));
  const Answer answer =
      answer_task(world, Task(world, 0, kNoLimit), {.reveal = Reveal::parse("edges"), .cover = Cover::kEdges});
  EXPECT_EQ(answer.edges->walked, 6);
}

TEST(ExploreEdges, OfKnownMapsArePlanned) {
  Rng rng(3);
  const World world = random_world(rng, 6, 6, EdgeKind::kUndirected, 1);
  const Answer answer = answer_task(world, Task(world, 0, kNoLimit), {.cover = Cover::kEdges});
  EXPECT_EQ(answer.policy, "postman");
  EXPECT_TRUE(answer.edges->all_cheapest);
}

TEST(ExploreEdges, RefusesWhatDoesNotGoWithEdges) {
  Rng rng(4);
  const World world = random_world(rng, 6, 6, EdgeKind::kUndirected, 1);
  const auto error = [&](PlanRequest request, End end = End::anywhere()) {
    request.cover = Cover::kEdges;
    if (request.reveal.all()) request.reveal = Reveal::parse("edges");
    return error_of([&] { answer_task(world, Task(world, 0, 10, end), request); });
  };
  EXPECT_THAT(error({.reveal = Reveal::parse("radius:2")}), HasSubstr("where visits show edges"));
  EXPECT_THAT(error({.score = Score::kSeen}), HasSubstr("not where they are seen"));
  EXPECT_THAT(error({.reset_cost = 1}), HasSubstr("one way"));
  EXPECT_THAT(error({.policy = "exact"}), HasSubstr("does not explore"));
  EXPECT_THAT(error({}, End::at(3)), HasSubstr("at the start"));
}

}  // namespace
}  // namespace graphdrl
