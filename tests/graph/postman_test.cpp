#include "graphdrl/graph/postman.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <queue>
#include <set>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/graph/search.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The least cost of a walk over all edges, by Dijkstra's algorithm over positions and edges walked.
double least_cost(const Multigraph& graph, bool directed, NodeId nodes, NodeId start, const PostmanOptions& options) {
  const auto all = (1U << graph.edges.size()) - 1;
  std::vector<std::vector<double>> best(nodes, std::vector<double>(all + 1, kNoLimit));
  using Entry = std::tuple<double, NodeId, unsigned>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap;
  const auto reach = [&](NodeId node, unsigned walked, double cost) {
    if (cost >= best[node][walked]) return;
    best[node][walked] = cost;
    heap.emplace(cost, node, walked);
  };
  reach(start, 0, 0);
  while (!heap.empty()) {
    const auto [cost, node, walked] = heap.top();
    heap.pop();
    if (cost > best[node][walked]) continue;
    if (walked == all && (options.end == kNoNode || node == options.end)) return cost;
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      const Edge& edge = graph.edges[i];
      if (edge.a == node) reach(edge.b, walked | 1U << i, cost + edge.cost);
      if (edge.b == node && (!directed || graph.leads_back(i))) reach(edge.a, walked | 1U << i, cost + edge.cost);
    }
    if (options.reset_cost) reach(start, walked, cost + *options.reset_cost);
  }
  return kNoLimit;
}

// Checks that it is a walk over all edges, and gives its cost.
double checked_cost(const EdgeWalk& walk, const Multigraph& graph, bool directed, NodeId start,
                    const PostmanOptions& options) {
  EXPECT_EQ(walk.nodes.size(), walk.edges.size() + 1);
  EXPECT_EQ(walk.nodes.front(), start);
  EXPECT_TRUE(options.end == kNoNode || walk.nodes.back() == options.end);
  std::set<std::int64_t> walked;
  double cost = 0;
  for (std::size_t i = 0; i < walk.edges.size(); ++i) {
    const NodeId from = walk.nodes[i];
    const NodeId to = walk.nodes[i + 1];
    if (walk.edges[i] == EdgeWalk::kResetEdge) {
      EXPECT_EQ(to, start);
      cost += options.reset_cost.value_or(kNoLimit);
      continue;
    }
    const Edge& edge = graph.edges[walk.edges[i]];
    const bool back = !directed || graph.leads_back(static_cast<std::size_t>(walk.edges[i]));
    EXPECT_TRUE((edge.a == from && edge.b == to) || (back && edge.b == from && edge.a == to));
    walked.insert(walk.edges[i]);
    cost += edge.cost;
  }
  EXPECT_EQ(walked.size(), graph.edges.size());
  return cost;
}

TEST(Postman, WalksAsShortAsAnyWalkOverAllEdges) {
  Rng rng(11);
  int found = 0;
  for (int round = 0; round < 600; ++round) {
    const bool directed = round % 2 == 0;
    const NodeId nodes = 2 + rng.index(4);
    Multigraph graph;
    const int edges = 1 + rng.index(8);
    const double unit = round % 3 == 0 ? 0.3 : 1;
    for (int i = 0; i < edges; ++i) {
      graph.edges.push_back({rng.index(nodes), rng.index(nodes), unit * (1 + rng.index(4))});
    }
    PostmanOptions options;
    if (rng.index(3) > 0) options.end = rng.index(nodes);
    if (directed && rng.index(2) == 0) options.reset_cost = rng.index(4);
    const EdgeKind kind = directed ? EdgeKind::kDirected : EdgeKind::kUndirected;
    const NodeId start = rng.index(nodes);
    const double least = least_cost(graph, directed, nodes, start, options);
    const auto walk = postman_walk(graph, kind, nodes, start, options);
    ASSERT_EQ(walk.has_value(), least < kNoLimit) << round;
    if (!walk) continue;
    ++found;
    EXPECT_NEAR(checked_cost(walk->walk, graph, directed, start, options), least, 1e-6) << round;
    EXPECT_NEAR(walk->walk.cost, least, 1e-6);
    EXPECT_NEAR(walk->bound, least, 1e-6);
  }
  EXPECT_GT(found, 200);
}

TEST(Postman, WalksMixedGraphsNearlyAsShortAsCanBe) {
  Rng rng(12);
  int found = 0;
  int best = 0;
  double walked = 0;
  double needed = 0;
  for (int round = 0; round < 400; ++round) {
    const NodeId nodes = 3 + rng.index(3);
    Multigraph graph;
    const int edges = 3 + rng.index(7);
    for (int i = 0; i < edges; ++i) {
      graph.edges.push_back({rng.index(nodes), rng.index(nodes), 1.0 + rng.index(4)});
      graph.both_ways.push_back(rng.index(2) == 0);
    }
    PostmanOptions options;
    if (rng.index(3) > 0) options.end = rng.index(nodes);
    if (rng.index(3) == 0) options.reset_cost = rng.index(4);
    const NodeId start = rng.index(nodes);
    const double least = least_cost(graph, /*directed=*/true, nodes, start, options);
    const auto walk = postman_walk(graph, EdgeKind::kDirected, nodes, start, options);
    ASSERT_EQ(walk.has_value(), least < kNoLimit) << round;
    if (!walk) continue;
    ++found;
    const double cost = checked_cost(walk->walk, graph, /*directed=*/true, start, options);
    EXPECT_EQ(cost, walk->walk.cost);
    EXPECT_GE(cost, least) << round;
    EXPECT_LE(walk->bound, least) << round;
    best += cost == least;
    walked += cost;
    needed += least;
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(best, found * 9 / 10);
  EXPECT_LT(walked, needed * 1.01);
}

// Some of these were too much for a matching that we used before.
TEST(Postman, WalksGridsOfAnySize) {
  for (int rows = 2; rows <= 12; ++rows) {
    for (int cols = rows; cols <= 12; ++cols) {
      Multigraph grid;
      for (NodeId row = 0; row < rows; ++row) {
        for (NodeId col = 0; col < cols; ++col) {
          const NodeId node = row * cols + col;
          if (col + 1 < cols) grid.edges.push_back({node, node + 1});
          if (row + 1 < rows) grid.edges.push_back({node, node + cols});
        }
      }
      // Closed: the odd nodes on the border are paired with their neighbours, but for what is left at corners.
      const auto walk = postman_walk(grid, EdgeKind::kUndirected, rows * cols, 0, {.end = 0});
      ASSERT_TRUE(walk);
      const double cost = checked_cost(walk->walk, grid, /*directed=*/false, 0, {.end = 0});
      const int odd = 2 * (rows - 2) + 2 * (cols - 2);
      EXPECT_GE(cost, static_cast<double>(std::ssize(grid.edges)) + odd / 2) << rows << " x " << cols;
      EXPECT_LE(cost, static_cast<double>(std::ssize(grid.edges)) + odd / 2 + rows + cols) << rows << " x " << cols;
    }
  }
}

TEST(Postman, StaysWhereThereAreNoEdges) {
  for (const EdgeKind kind : {EdgeKind::kDirected, EdgeKind::kUndirected}) {
    EXPECT_THAT(postman_walk({}, kind, 2, 1, {})->walk.nodes, ElementsAre(1));
  }
}

TEST(Postman, WalksAPathThereAndBack) {
  const Multigraph path{.edges = {{0, 1}, {1, 2}}};
  EXPECT_THAT(postman_walk(path, EdgeKind::kUndirected, 3, 0, {.end = 0})->walk.nodes, ElementsAre(0, 1, 2, 1, 0));
  EXPECT_THAT(postman_walk(path, EdgeKind::kUndirected, 3, 0, {})->walk.nodes, ElementsAre(0, 1, 2));
  EXPECT_THAT(postman_walk(path, EdgeKind::kUndirected, 3, 1, {})->walk.nodes.size(), 4);
  EXPECT_FALSE(postman_walk(path, EdgeKind::kDirected, 3, 1, {}));
  EXPECT_EQ(postman_walk(path, EdgeKind::kDirected, 3, 0, {.end = 0, .reset_cost = 5})->walk.cost, 7);
  EXPECT_THAT(error_of([&] { postman_walk(path, EdgeKind::kUndirected, 3, 0, {.reset_cost = 1}); }),
              HasSubstr("one way"));
}

}  // namespace
}  // namespace graphdrl
