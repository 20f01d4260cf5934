#include "graphdrl/graph/graph_generators.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

bool is_connected(const Graph& graph) {
  return count_components(graph, std::vector<bool>(graph.node_count())) == 1;
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

TEST(GraphGenerators, CostLengths) {
  Rng rng(4);
  const Graph graph = geometric_graph(300, 6, true, rng);
  EXPECT_TRUE(graph.weighted());
  EXPECT_NEAR(graph.mean_cost(), 1, 1e-9);
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

}  // namespace
}  // namespace graphdrl
