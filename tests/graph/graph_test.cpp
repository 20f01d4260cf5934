#include "graphdrl/graph/graph.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "graphdrl/base/parallel.h"
#include "graphdrl/graph/components.h"
#include "graphdrl/graph/grid_map.h"
#include "graphdrl/graph/search.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Graph, KeepsNeighboursAscendingAndEdgesOnce) {
  const std::vector<Edge> edges = {{2, 0}, {0, 1}, {1, 0}, {3, 0}};
  const Graph graph = Graph::from_edges(4, edges);
  EXPECT_EQ(graph.node_count(), 4);
  EXPECT_EQ(graph.edge_count(), 3);
  EXPECT_THAT(graph.neighbours(0), ElementsAre(1, 2, 3));
  EXPECT_THAT(graph.neighbours(3), ElementsAre(0));
}

TEST(Graph, LeavesOutLoopsAndRefusesStrangeNodesAndCosts) {
  const std::vector<Edge> loop = {{1, 1}, {0, 1}};
  EXPECT_EQ(Graph::from_edges(3, loop).edge_count(), 1);
  for (const double cost : {-1.0, -1e-300, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    const std::vector<Edge> edge = {{0, 1, cost}};
    EXPECT_THAT(error_of([&] { Graph::from_edges(2, edge); }), HasSubstr("bad cost of the edge from 0 to 1"));
  }
  const std::vector<Edge> far = {{0, 3}};
  EXPECT_THAT(error_of([&] { Graph::from_edges(3, far); }), HasSubstr("expected node ids 0 to 2, got 3"));
}

TEST(Graph, KeepsTheCheapestOfParallelEdges) {
  const std::vector<Edge> edges = {{0, 1, 3}, {1, 0, 2}, {1, 2, 4}};
  const Graph graph = Graph::from_edges(3, edges);
  EXPECT_EQ(graph.edge_count(), 2);
  EXPECT_TRUE(graph.weighted());
  EXPECT_EQ(graph.cost(0, 0), 2);
  EXPECT_EQ(graph.cost(1, 1), 4);
  EXPECT_EQ(graph.mean_cost(), 3);
  const std::vector<Edge> unit = {{0, 1, 1}};
  EXPECT_FALSE(Graph::from_edges(2, unit).weighted());
}

TEST(Graph, SortsManyParallelEdgesAndLoops) {
  Rng rng(1);
  for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
    std::vector<Edge> edges;
    std::map<std::pair<NodeId, NodeId>, double> cheapest;  // by source and target
    for (int i = 0; i < 500; ++i) {
      const Edge edge{static_cast<NodeId>(rng.below(12)), static_cast<NodeId>(rng.below(12)), rng.uniform()};
      edges.push_back(edge);
      if (edge.a == edge.b) continue;
      const auto note = [&](NodeId a, NodeId b) {
        const auto known = cheapest.try_emplace({a, b}, edge.cost).first;
        known->second = std::min(known->second, edge.cost);
      };
      note(edge.a, edge.b);
      if (kind == EdgeKind::kUndirected) note(edge.b, edge.a);
    }
    const Graph graph = Graph::from_edges(12, edges, kind);
    auto expected = cheapest.begin();
    for (NodeId node = 0; node < 12; ++node) {
      for (int i = 0; i < graph.degree(node); ++i, ++expected) {
        ASSERT_EQ(expected->first, std::pair(node, graph.neighbours(node)[i]));
        EXPECT_EQ(expected->second, graph.cost(node, i));
      }
    }
    EXPECT_EQ(expected, cheapest.end());
  }
}

TEST(Graph, CostsMayBeZero) {
  const std::vector<Edge> edges = {{0, 1, 0}, {1, 2, 3}, {2, 3, -0.0}};
  const Graph graph = Graph::from_edges(4, edges);
  EXPECT_EQ(graph.cost(0, 0), 0);
  EXPECT_FALSE(std::signbit(graph.cost(3, 0)));
  EXPECT_EQ(graph.mean_cost(), 1);
  EXPECT_EQ(graph.without({false, false, true, false}).mean_cost(), 1) << "all that are left cost 0";
  EXPECT_EQ(graph.without({false, false, true, false}).max_cost(), 0);
}

TEST(Graph, KnowsItsCosts) {
  const auto of = [](std::vector<Edge> edges) { return Graph::from_edges(4, edges); };
  const Graph whole = of({{0, 1, 2}, {1, 2, 7}, {2, 3, 0}});
  EXPECT_TRUE(whole.integer_costs());
  EXPECT_EQ(whole.min_cost(), 0);
  EXPECT_EQ(whole.max_cost(), 7);
  EXPECT_EQ(whole.mean_cost(), 3);
  EXPECT_FALSE(of({{0, 1, 2}, {1, 2, 2.5}}).integer_costs());
  EXPECT_TRUE(of({{0, 1, 0x1p51}}).integer_costs());
  EXPECT_FALSE(of({{0, 1, 0x1p52}}).integer_costs()) << "there and back is 2^53";
  EXPECT_FALSE(of({{0, 1, 1e300}}).integer_costs());
  const Graph plain = of({{0, 1}});
  EXPECT_TRUE(plain.integer_costs() && plain.min_cost() == 1 && plain.max_cost() == 1 && plain.mean_cost() == 1);
  EXPECT_TRUE(Graph::grid(2, 2).integer_costs());
  EXPECT_TRUE(Graph().integer_costs());
  const Graph part = of({{0, 1, 2}, {1, 2, 2.5}}).without({false, false, true, false});
  EXPECT_TRUE(part.integer_costs());
  EXPECT_EQ(part.max_cost(), 2);
}

TEST(Graph, DirectedEdgesLeadOneWay) {
  const std::vector<Edge> edges = {{0, 1, 3}, {1, 0, 2}, {1, 2, 4}};
  const Graph graph = Graph::from_edges(3, edges, EdgeKind::kDirected);
  EXPECT_EQ(graph.edge_count(), 3);
  EXPECT_THAT(graph.neighbours(1), ElementsAre(0, 2));
  EXPECT_THAT(graph.neighbours(2), ElementsAre());
  const Graph turned = graph.reversed();
  EXPECT_THAT(turned.neighbours(2), ElementsAre(1));
  EXPECT_EQ(turned.cost(2, 0), 4);
  EXPECT_EQ(turned.cost(0, 0), 2);
  EXPECT_TRUE(turned.without({false, true, false}).directed());
  EXPECT_EQ(graph.without({false, false, true}).edge_count(), 2);
}

// The way to the first node that a search meets of those that are goals, through those that may be entered.
template <typename IsGoal, typename MayEnter>
std::vector<NodeId> path_to_nearest(const Graph& graph, NodeId from, const IsGoal& is_goal, const MayEnter& may_enter) {
  NearestFirst search;
  NodeId goal = kNoNode;
  search.run(graph, from, kNoLimit, [&](NodeId node, double) {
    if (!may_enter(node)) return NearestFirst::Next::kPast;
    if (!is_goal(node)) return NearestFirst::Next::kThrough;
    goal = node;
    return NearestFirst::Next::kEnd;
  });
  std::vector<NodeId> path;
  if (goal != kNoNode) search.append_path_to(goal, path);
  return path;
}

TEST(Search, GoesByCostWhereEdgesHaveCosts) {
  const std::vector<Edge> edges = {{0, 1, 5}, {0, 2, 1}, {2, 1, 1}, {1, 3, 1}};
  const Graph graph = Graph::from_edges(4, edges);
  EXPECT_THAT(path_to_nearest(
                  graph, 0, [](NodeId node) { return node == 3; }, [](NodeId) { return true; }),
              ElementsAre(2, 1, 3));
}

TEST(Graph, GridNeighboursStandLeftUpRightDown) {
  const Graph grid = Graph::grid(3, 3);
  EXPECT_EQ(grid.edge_count(), 12);
  EXPECT_THAT(grid.neighbours(4), ElementsAre(3, 1, 5, 7));
  EXPECT_THAT(grid.neighbours(0), ElementsAre(1, 3));
  EXPECT_THAT(grid.neighbours(8), ElementsAre(7, 5));
  EXPECT_EQ(Graph::grid(5, 5).edge_count(), 40);
}

TEST(Graph, WithoutDropsTheEdgesOfANode) {
  const Graph rest = Graph::grid(3, 3).without({false, false, false, false, true, false, false, false, false});
  EXPECT_EQ(rest.node_count(), 9);
  EXPECT_EQ(rest.edge_count(), 8);
  EXPECT_THAT(rest.neighbours(1), ElementsAre(0, 2));
  EXPECT_EQ(rest.degree(4), 0);
}

TEST(Search, FindsTheNearestInNeighbourOrder) {
  const Graph grid = Graph::grid(3, 3);
  const auto anywhere = [](NodeId) { return true; };
  const auto corner = [](NodeId node) { return node == 0 || node == 8; };
  EXPECT_THAT(path_to_nearest(grid, 4, corner, anywhere), ElementsAre(3, 0));  // left before up
  const auto around = [](NodeId node) { return node != 3 && node != 1; };
  EXPECT_THAT(path_to_nearest(grid, 4, corner, around), ElementsAre(5, 8));
  EXPECT_TRUE(path_to_nearest(
                  grid, 4, [](NodeId) { return false; }, anywhere)
                  .empty());
}

TEST(Search, CountsComponents) {
  EXPECT_EQ(find_components(Graph::grid(1, 3), {false, true, false}).count(), 2);
  EXPECT_EQ(find_components(Graph::grid(2, 2), {false, false, false, false}).count(), 1);
}

// Whatever the number of threads, of all edges, one by one.
TEST(Graph, KnowsTheCostsOfACompleteGraph) {
  class Costs final : public PairCosts {
   public:
    explicit Costs(double unit) : unit_(unit) {}
    double cost(NodeId from, NodeId to) const override { return unit_ * (1 + (from * from + to * to) % 17); }

   private:
    double unit_;
  };
  for (const double unit : {1.0, 0.3}) {
    for (const int count : {1, 2, 3, 50}) {
      set_threads(1);
      const Graph one = Graph::complete(count, std::make_shared<Costs>(unit));
      set_threads(3);
      const Graph graph = Graph::complete(count, std::make_shared<Costs>(unit));
      set_threads(1);
      EXPECT_EQ(graph.mean_cost(), one.mean_cost());
      const Graph plain = Graph::from_edges(count, graph.edges());
      EXPECT_EQ(graph.min_cost(), plain.min_cost());
      EXPECT_EQ(graph.max_cost(), plain.max_cost());
      EXPECT_NEAR(graph.mean_cost(), plain.mean_cost(), 1e-12 * plain.mean_cost());
      EXPECT_EQ(graph.integer_costs(), plain.integer_costs());
    }
  }
}

TEST(Graph, GrowsIntoTheSameGraph) {
  Rng rng(8);
  for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
    for (const double step : {1.0, 0.5}) {
      std::vector<Edge> edges;
      for (NodeId a = 0; a < 30; ++a) {
        for (NodeId b = 0; b < a; ++b) {
          if (rng.uniform() < 0.4) edges.push_back({a, b, step == 1 ? 1 : step * (1 + rng.index(5))});
        }
      }
      for (int left = static_cast<int>(edges.size()); left > 1; --left)
        std::swap(edges[rng.index(left)], edges[left - 1]);
      Graph grown(kind);
      for (NodeId node = 0; node < 30; ++node) EXPECT_EQ(grown.add_node(), node);
      for (const Edge& edge : edges) grown.add_edge(edge);
      const Graph made = Graph::from_edges(30, edges, kind);
      EXPECT_EQ(grown.edge_count(), made.edge_count());
      EXPECT_EQ(grown.weighted(), made.weighted());
      EXPECT_EQ(grown.min_cost(), made.min_cost());
      EXPECT_EQ(grown.max_cost(), made.max_cost());
      EXPECT_NEAR(grown.mean_cost(), made.mean_cost(), 1e-12);
      EXPECT_EQ(grown.integer_costs(), made.integer_costs());
      for (NodeId node = 0; node < 30; ++node) {
        ASSERT_TRUE(std::ranges::equal(grown.neighbours(node), made.neighbours(node)));
        for (int i = 0; i < made.degree(node); ++i) EXPECT_EQ(grown.cost(node, i), made.cost(node, i));
      }
    }
  }
}

TEST(Graph, LosesEdges) {
  Rng rng(9);
  for (const EdgeKind kind : {EdgeKind::kUndirected, EdgeKind::kDirected}) {
    for (const int most_cost : {1, 5}) {
      std::vector<Edge> edges;
      for (NodeId a = 0; a < 20; ++a) {
        for (NodeId b = 0; b < a; ++b) {
          if (rng.uniform() < 0.5) edges.push_back({a, b, 1.0 + rng.index(most_cost)});
        }
      }
      Graph graph = Graph::from_edges(20, edges, kind);
      while (!edges.empty()) {
        const int lost = rng.index(static_cast<int>(edges.size()));
        graph.remove_edge(edges[lost].a, edges[lost].b);
        edges.erase(edges.begin() + lost);
        const Graph made = Graph::from_edges(20, edges, kind);
        ASSERT_EQ(graph.edge_count(), made.edge_count());
        EXPECT_NEAR(graph.mean_cost(), made.mean_cost(), 1e-12);
        EXPECT_LE(graph.min_cost(), made.min_cost());
        EXPECT_GE(graph.max_cost(), made.max_cost());
        EXPECT_TRUE(graph.integer_costs());
        for (NodeId node = 0; node < 20; ++node) {
          ASSERT_TRUE(std::ranges::equal(graph.neighbours(node), made.neighbours(node)));
          for (int i = 0; i < made.degree(node); ++i) EXPECT_EQ(graph.cost(node, i), made.cost(node, i));
        }
      }
      graph.add_edge({3, 4, 2});
      EXPECT_EQ(graph.max_cost(), 2);
    }
  }
}

TEST(Graph, TakesEdgesAtAPlace) {
  Graph graph(EdgeKind::kUndirected);
  for (int node = 0; node < 4; ++node) graph.add_node();
  graph.add_edge({0, 1});
  graph.add_edge({0, 2}, {.of_b = 0, .of_a = 0});
  graph.add_edge({0, 3}, {.of_b = 1, .of_a = 0});
  EXPECT_THAT(graph.neighbours(0), ElementsAre(2, 3, 1));
}

}  // namespace
}  // namespace graphdrl
