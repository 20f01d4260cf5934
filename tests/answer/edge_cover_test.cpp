#include "graphdrl/answer/edge_cover.h"

#include <gmock/gmock.h>

#include <queue>
#include <set>
#include <tuple>
#include <vector>

#include "graphdrl/answer/answer.h"
#include "graphdrl/base/random.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// Edges, with their prizes or none.
World world_of_edges(const Multigraph& all, NodeId nodes, EdgeKind kind) {
  GraphMap map;
  set_edges(map, nodes, all, kind);
  map.multigraph = std::make_shared<const Multigraph>(all);
  map.blocked.resize(nodes);
  return World("test", std::move(map));
}

struct EdgeTask {
  double budget;
  NodeId start;
  NodeId end;  // kNoNode: anywhere
  std::optional<double> reset_cost = {};
};

// The most that a walk's edges are worth, by the cheapest way to each position with each set of edges walked.
double best_prize(const Multigraph& all, bool directed, NodeId nodes, const EdgeTask& asked) {
  const std::vector<Edge>& edges = all.edges;
  std::vector<std::vector<double>> least(nodes, std::vector<double>(std::size_t{1} << edges.size(), kNoLimit));
  std::queue<std::pair<NodeId, unsigned>> queue;
  double most = -1;
  const auto worth = [&](unsigned walked) {
    double sum = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) sum += (walked >> i & 1U) != 0 ? all.prize(i) : 0;
    return sum;
  };
  const auto reach = [&](NodeId node, unsigned walked, double cost) {
    if (cost > asked.budget + 1e-9 || cost >= least[node][walked]) return;
    least[node][walked] = cost;
    queue.emplace(node, walked);
    if (asked.end == kNoNode || node == asked.end) most = std::max(most, worth(walked));
  };
  reach(asked.start, 0, 0);
  while (!queue.empty()) {
    const auto [node, walked] = queue.front();
    queue.pop();
    const double cost = least[node][walked];
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (edges[i].a == node) reach(edges[i].b, walked | 1U << i, cost + edges[i].cost);
      if (edges[i].b == node && (!directed || all.leads_back(i)))
        reach(edges[i].a, walked | 1U << i, cost + edges[i].cost);
    }
    if (asked.reset_cost) reach(asked.start, walked, cost + *asked.reset_cost);
  }
  return most;
}

// Checks the walk that make_plan() gives, and gives what its edges are worth; -1 where there is none.
double planned_prize(const Multigraph& all, bool directed, NodeId nodes, const EdgeTask& asked,
                     double* bound = nullptr) {
  const std::vector<Edge>& edges = all.edges;
  const World world = world_of_edges(all, nodes, directed ? EdgeKind::kDirected : EdgeKind::kUndirected);
  const End end = asked.end == kNoNode ? End::anywhere() : End::at(asked.end);
  std::optional<Task> task;
  try {
    task.emplace(world, asked.start, asked.budget, end);
  } catch (const Error&) {
    return -1;  // the end is out of reach without resets
  }
  const Answer answer =
      make_plan(world, *task, {.policy = "search:2000", .cover = Cover::kEdges, .reset_cost = asked.reset_cost});
  const EdgeCover& cover = answer.edges.value();
  std::set<std::int64_t> walked;
  double cost = 0;
  EXPECT_EQ(cover.walk.nodes.front(), asked.start);
  EXPECT_TRUE(asked.end == kNoNode || cover.walk.nodes.back() == asked.end);
  for (std::size_t i = 0; i < cover.walk.edges.size(); ++i) {
    const std::int64_t edge = cover.walk.edges[i];
    const NodeId from = cover.walk.nodes[i];
    const NodeId to = cover.walk.nodes[i + 1];
    if (edge < 0) {
      EXPECT_EQ(to, asked.start);
      cost += asked.reset_cost.value_or(kNoLimit);
      continue;
    }
    const Edge& one = edges[static_cast<std::size_t>(edge)];
    const bool back = !directed || all.leads_back(static_cast<std::size_t>(edge));
    EXPECT_TRUE((one.a == from && one.b == to) || (back && one.b == from && one.a == to));
    walked.insert(edge);
    cost += one.cost;
  }
  EXPECT_NEAR(cost, cover.walk.cost, 1e-9);
  EXPECT_LE(cost, asked.budget + 1e-9);
  EXPECT_EQ(std::ssize(walked), cover.walked);
  double prize = 0;
  for (const std::int64_t edge : walked) prize += all.prize(static_cast<std::size_t>(edge));
  EXPECT_EQ(prize, cover.prize);
  EXPECT_LE(cover.prize, cover.bound + 1e-9);
  if (bound != nullptr) *bound = cover.bound;
  return prize;
}

struct Case {
  Multigraph all;
  bool directed;
  NodeId nodes;
  EdgeTask asked;
};

Case random_case(Rng& rng, int edges, bool directed) {
  Case made{.all = {}, .directed = directed, .nodes = 3 + rng.index(3), .asked = {}};
  for (int i = 0; i < edges; ++i) {
    made.all.edges.push_back({rng.index(made.nodes), rng.index(made.nodes), 1.0 + rng.index(3)});
  }
  const bool mixed = directed && rng.index(2) == 0;
  for (int i = 0; mixed && i < edges; ++i) made.all.both_ways.push_back(rng.index(2) == 0);
  const bool prizes = rng.index(2) == 0;
  for (int i = 0; prizes && i < edges; ++i) made.all.prizes.push_back(rng.index(5));
  made.asked = {.budget = static_cast<double>(rng.index(2 * edges)), .start = rng.index(made.nodes), .end = kNoNode};
  if (rng.index(2) == 0) made.asked.end = rng.index(made.nodes);
  if (directed && rng.index(2) == 0) made.asked.reset_cost = 1 + rng.index(3);
  return made;
}

TEST(EdgeCover, IsTheBestOnSmallGraphs) {
  Rng rng(21);
  for (int round = 0; round < 300; ++round) {
    const Case one = random_case(rng, 1 + rng.index(7), round % 2 == 0);
    const double planned = planned_prize(one.all, one.directed, one.nodes, one.asked);
    if (planned < 0) continue;
    EXPECT_EQ(planned, best_prize(one.all, one.directed, one.nodes, one.asked)) << round;
  }
}

TEST(EdgeCover, IsNeverAboveTheBestAndItsBoundNeverBelow) {
  Rng rng(22);
  double planned_sum = 0;
  double best_sum = 0;
  for (int round = 0; round < 40; ++round) {
    const Case one = random_case(rng, 13, round % 2 == 0);
    double bound = 0;
    const double planned = planned_prize(one.all, one.directed, one.nodes, one.asked, &bound);
    if (planned < 0) continue;
    const double best = best_prize(one.all, one.directed, one.nodes, one.asked);
    EXPECT_LE(planned, best) << round;
    EXPECT_GE(bound, best - 1e-9) << round;
    planned_sum += planned;
    best_sum += best;
  }
  EXPECT_GE(planned_sum * 100, best_sum * 95);
}

TEST(EdgeCover, KnowsTheCheapestWalkOverAllEdges) {
  const World world = grid_world("..\n..\n");
  const Answer answer = make_plan(world, Task(world, 0, kNoLimit), {.cover = Cover::kEdges});
  EXPECT_TRUE(answer.edges->all_cheapest);
  EXPECT_EQ(answer.policy, "postman");
  EXPECT_EQ(answer.plan.cost, 4);
  EXPECT_EQ(plan_summary(answer)[0], "walked 4 of 4 edges, 100.0 %, for 4");
  EXPECT_THAT(error_of([&] { make_plan(world, Task(world, 0, 9), {.cover = Cover::kEdges, .reset_cost = 1}); }),
              HasSubstr("one way"));
  EXPECT_THAT(error_of([&] { make_plan(world, Task(world, 0, 9), {.reset_cost = 1}); }), HasSubstr("edges"));
}

}  // namespace
}  // namespace graphdrl
