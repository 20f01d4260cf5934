#include "graphdrl/graph/graph_generators.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

bool is_connected(const Graph& graph) {
  return find_components(graph, std::vector<bool>(graph.node_count())).count() == 1;
}

double mean_degree(const Graph& graph) {
  return 2.0 * static_cast<double>(graph.edge_count()) / graph.node_count();
}

TEST(GraphGenerators, GiveWhatTheirNamesSay) {
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const int nodes = 2 + static_cast<int>(rng.below(60));
    const Graph tree = random_tree(nodes, rng);
    EXPECT_EQ(tree.edge_count(), nodes - 1);
    EXPECT_TRUE(is_connected(tree));

    const Graph attached = barabasi_albert_graph(nodes, 2, rng);
    EXPECT_EQ(attached.edge_count(), 1 + 2 * (nodes - 2));
    EXPECT_TRUE(is_connected(attached));

    const Graph ring = watts_strogatz_graph(nodes + 3, 2, 0, rng);
    for (NodeId node = 0; node < ring.node_count(); ++node) EXPECT_EQ(ring.degree(node), 4);
    EXPECT_EQ(watts_strogatz_graph(nodes + 3, 2, 0.5, rng).edge_count(), ring.edge_count());
  }
  EXPECT_NEAR(mean_degree(erdos_renyi_graph(600, 3, rng)), 3, 0.4);
  EXPECT_NEAR(mean_degree(geometric_graph(2000, 6, false, rng)), 6, 0.5);
  EXPECT_EQ(random_tree(1, rng).node_count(), 1);
  EXPECT_EQ(barabasi_albert_graph(1, 2, rng).edge_count(), 0);
}

TEST(GraphGenerators, DrawTreesUniformly) {
  // Of the 16 trees on 4 nodes 4 are stars.
  Rng rng(2);
  int stars = 0;
  for (int i = 0; i < 4000; ++i) {
    const Graph tree = random_tree(4, rng);
    for (NodeId node = 0; node < 4; ++node) stars += tree.degree(node) == 3;
  }
  EXPECT_NEAR(stars / 4000.0, 0.25, 0.03);
}

TEST(GraphGenerators, LinkToTheWellLinked) {
  Rng rng(3);
  double oldest = 0;
  double newest = 0;
  for (int i = 0; i < 30; ++i) {
    const Graph graph = barabasi_albert_graph(200, 2, rng);
    for (NodeId node = 0; node < 10; ++node) {
      oldest += graph.degree(node);
      newest += graph.degree(199 - node);
    }
  }
  EXPECT_GT(oldest, 4 * newest);
}

// Triangles times three, over pairs of neighbours: the share of pairs of a node's neighbours that are joined.
double transitivity(const Graph& graph) {
  double pairs = 0;
  double joined = 0;
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    const auto near = graph.neighbours(node);
    for (std::size_t i = 0; i < near.size(); ++i) {
      const auto of_one = graph.neighbours(near[i]);
      for (std::size_t j = i + 1; j < near.size(); ++j) {
        ++pairs;
        joined += std::binary_search(of_one.begin(), of_one.end(), near[j]);
      }
    }
  }
  return joined / pairs;
}

TEST(GraphGenerators, CloseTriangles) {
  double before = 0;
  for (const double triads : {0.0, 0.5, 1.0}) {
    Rng rng(10);
    const Graph graph = power_law_cluster_graph(400, 3, triads, rng);
    EXPECT_EQ(graph.edge_count(), 1 + 2 + 3 * (400 - 3));
    EXPECT_TRUE(is_connected(graph));
    EXPECT_GT(transitivity(graph), before + 0.03) << triads;
    before = transitivity(graph);
  }
  // From the third node on, the second edge closes a triangle with the first: all edges are in one.
  Rng rng(11);
  const Graph graph = power_law_cluster_graph(50, 2, 1, rng);
  for (const Edge& edge : graph.edges()) {
    const auto near = graph.neighbours(edge.a);
    const auto others = graph.neighbours(edge.b);
    EXPECT_TRUE(
        std::ranges::any_of(near, [&](NodeId node) { return std::binary_search(others.begin(), others.end(), node); }));
  }
  EXPECT_EQ(power_law_cluster_graph(1, 2, 1, rng).edge_count(), 0);
}

TEST(GraphGenerators, CostLengths) {
  Rng rng(4);
  const Graph graph = geometric_graph(300, 6, true, rng);
  EXPECT_TRUE(graph.weighted());
  EXPECT_NEAR(graph.mean_cost(), 1, 1e-9);
}

TEST(GraphGenerators, GeometricLooksAtEveryPair) {
  for (const int nodes : {1, 2, 7, 60, 400}) {
    for (const double degree : {0.01, 1.0, 6.0, 80.0}) {
      Rng rng(7);
      Rng same(7);
      const Graph graph = geometric_graph(nodes, degree, true, rng);
      const double radius = std::sqrt(degree / (std::numbers::pi * nodes));
      std::vector<double> x(nodes);
      std::vector<double> y(nodes);
      for (int i = 0; i < nodes; ++i) {
        x[i] = same.uniform();
        y[i] = same.uniform();
      }
      std::vector<Edge> edges;
      double sum = 0;
      for (int a = 0; a < nodes; ++a) {
        for (int b = a + 1; b < nodes; ++b) {
          const double length = std::hypot(x[a] - x[b], y[a] - y[b]);
          if (length < radius) edges.push_back({a, b, length});
          if (length < radius) sum += length;
        }
      }
      for (Edge& edge : edges) edge.cost /= sum / static_cast<double>(edges.size());
      const std::vector<Edge> found = graph.edges();
      ASSERT_EQ(found.size(), edges.size());
      for (std::size_t i = 0; i < edges.size(); ++i) {
        EXPECT_TRUE(found[i].a == edges[i].a && found[i].b == edges[i].b && found[i].cost == edges[i].cost);
      }
    }
  }
}

TEST(GraphGenerators, WattsStrogatzIsThatOfTheMatrix) {
  for (int nodes = 1; nodes <= 40; ++nodes) {
    for (const int reach : {1, 2, 5}) {
      Rng rng(nodes);
      Rng same(nodes);
      std::vector<std::vector<bool>> matrix(nodes, std::vector<bool>(nodes));
      const auto set = [&](int a, int b, bool value) { matrix[a][b] = matrix[b][a] = value; };
      for (int node = 0; node < nodes; ++node) {
        for (int step = 1; step <= reach && step < nodes; ++step) set(node, (node + step) % nodes, true);
      }
      for (int step = 1; step <= reach && step < nodes; ++step) {
        for (int node = 0; node < nodes; ++node) {
          if (same.uniform() >= 0.4) continue;
          const int next = static_cast<int>(same.below(static_cast<std::uint32_t>(nodes)));
          if (next == node || matrix[node][next]) continue;
          set(node, (node + step) % nodes, false);
          set(node, next, true);
        }
      }
      const Graph graph = watts_strogatz_graph(nodes, reach, 0.4, rng);
      for (NodeId a = 0; a < nodes; ++a) {
        const auto next = graph.neighbours(a);
        for (NodeId b = 0; b < nodes; ++b) {
          EXPECT_EQ(std::binary_search(next.begin(), next.end(), b), matrix[a][b]) << nodes << ' ' << reach;
        }
      }
    }
  }
}

TEST(GraphGenerators, TakeAMillionNodes) {
  constexpr int kNodes = 1'000'000;
  Rng rng(8);
  EXPECT_EQ(watts_strogatz_graph(kNodes, 2, 0.2, rng).edge_count(), 2 * kNodes);
  EXPECT_NEAR(mean_degree(geometric_graph(kNodes, 5, false, rng)), 5, 0.05);
  Rng draws = rng;
  const Graph sparse = erdos_renyi_graph(kNodes, 3, rng);
  EXPECT_NEAR(mean_degree(sparse), 3, 0.02);
  for (std::int64_t i = 0; i <= sparse.edge_count(); ++i) draws.next();
  EXPECT_EQ(draws.state(), rng.state()) << "a number per edge, and one to pass the end";
  EXPECT_EQ(erdos_renyi_graph(kNodes, 0, rng).edge_count(), 0);
}

// The pairs that skips lead to are as likely as all others: whether they are near the begin or the end.
TEST(GraphGenerators, SkipsReachAllPairs) {
  constexpr int kNodes = 30'000;
  Rng rng(9);
  const Graph graph = erdos_renyi_graph(kNodes, 40, rng);
  for (const int begin : {0, 14'000, 29'000}) {
    double degrees = 0;
    for (NodeId node = begin; node < begin + 1000; ++node) degrees += graph.degree(node);
    EXPECT_NEAR(degrees / 1000, 40, 1) << begin;
  }
}

TEST(LargestPart, KeepsTheLargestWithItsCosts) {
  const std::vector<Edge> edges = {{0, 1}, {2, 4, 3.0}, {4, 5}};
  const Graph part = largest_part(Graph::from_edges(6, edges));
  ASSERT_EQ(part.node_count(), 3);
  EXPECT_EQ(part.edge_count(), 2);
  EXPECT_EQ(part.cost(0, 0), 3.0);  // of 2 - 4, now 0 - 1
}

TEST(RandomCosts, AreFromOneToTheMost) {
  Rng rng(5);
  const Graph graph = with_random_costs(erdos_renyi_graph(100, 6, rng), 5, rng);
  std::vector<int> seen(6);
  for (const Edge& edge : graph.edges()) {
    ASSERT_EQ(edge.cost, std::floor(edge.cost));
    ++seen.at(static_cast<std::size_t>(edge.cost));
  }
  EXPECT_EQ(seen[0], 0);
  for (int cost = 1; cost <= 5; ++cost) EXPECT_GT(seen[cost], 0);
}

TEST(OneWayEdges, LeadOneWayInTheirShare) {
  Rng rng(6);
  const Graph graph = erdos_renyi_graph(300, 8, rng);
  const Graph directed = with_one_way_edges(graph, 0.3, rng);
  EXPECT_TRUE(directed.directed());
  const double arcs_per_edge = static_cast<double>(directed.edge_count()) / static_cast<double>(graph.edge_count());
  EXPECT_NEAR(arcs_per_edge, 1.7, 0.05);
  EXPECT_EQ(with_one_way_edges(graph, 0, rng).edge_count(), 2 * graph.edge_count());
}

TEST(LargestPart, IsThatOfTheLowestNodeAmongEquallyLargeOnes) {
  const std::vector<Edge> edges = {{1, 2, 5}, {0, 3, 4}};
  const Graph part = largest_part(Graph::from_edges(4, edges));
  EXPECT_EQ(part.node_count(), 2);
  EXPECT_EQ(part.cost(0, 0), 4);
}

}  // namespace
}  // namespace graphdrl
