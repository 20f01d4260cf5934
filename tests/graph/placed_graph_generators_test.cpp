#include "graphdrl/graph/placed_graph_generators.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

using testing::ElementsAre;
using testing::Pair;

bool has_one_part(const GraphMap& map) {
  return find_components(map.graph, map.blocked).count() == 1;
}

// How many nodes have each degree.
std::map<int, int> degrees_of(const GraphMap& map) {
  std::map<int, int> count;
  for (NodeId node = 0; node < map.graph.node_count(); ++node) ++count[map.graph.degree(node)];
  return count;
}

double length_of(const GraphMap& map, const Edge& edge) {
  const Point a = map.places.points[edge.a];
  const Point b = map.places.points[edge.b];
  return std::hypot(a.x - b.x, a.y - b.y);
}

std::size_t different_places(const GraphMap& map) {
  std::set<std::pair<double, double>> places;  // to three digits
  for (const Point& point : map.places.points) places.insert({std::round(1e3 * point.x), std::round(1e3 * point.y)});
  return places.size();
}

// Edges with the places of their ends, whatever the numbers of the nodes.
std::multiset<std::vector<double>> drawn_edges(const GraphMap& map) {
  std::multiset<std::vector<double>> edges;
  for (const Edge& edge : map.graph.edges()) {
    const Point a = map.places.points[edge.a];
    const Point b = map.places.points[edge.b];
    const bool in_order = std::pair(a.x, a.y) < std::pair(b.x, b.y);
    const Point& from = in_order ? a : b;
    const Point& to = in_order ? b : a;
    edges.insert({from.x, from.y, to.x, to.y, edge.cost});
  }
  return edges;
}

TEST(PlacedGraphs, LaddersHaveRungs) {
  const GraphMap map = ladder_map(10);
  EXPECT_EQ(map.graph.edge_count(), 2 * 9 + 10);
  EXPECT_THAT(degrees_of(map), ElementsAre(Pair(2, 4), Pair(3, 16)));
  for (const Edge& edge : map.graph.edges()) EXPECT_EQ(length_of(map, edge), 1);
  EXPECT_EQ(ladder_map(1).graph.edge_count(), 1);
}

TEST(PlacedGraphs, HexagonsAreRegular) {
  const GraphMap map = hexagons_map(6, 9);
  EXPECT_EQ(map.graph.edge_count(), 6 * 8 + 5 + 4 + 5 + 4 + 5);
  EXPECT_THAT(degrees_of(map), ElementsAre(Pair(2, 20), Pair(3, 34)));
  EXPECT_TRUE(has_one_part(map));
  EXPECT_EQ(different_places(map), 54u);
  for (const Edge& edge : map.graph.edges()) EXPECT_NEAR(length_of(map, edge), 1, 1e-9);
  EXPECT_EQ(degrees_of(hexagons_map(6, 8)).at(1), 2) << "corners that are dead ends";
}

TEST(PlacedGraphs, TrianglesAreEquilateral) {
  const GraphMap map = triangles_map(5, 7);
  EXPECT_EQ(map.graph.edge_count(), 5 * 6 + 4 * (2 * 7 - 1));
  const std::map<int, int> degrees = degrees_of(map);
  EXPECT_EQ(degrees.at(6), 3 * 5) << "all within the border";
  EXPECT_EQ(degrees.rbegin()->first, 6);
  for (const Edge& edge : map.graph.edges()) EXPECT_NEAR(length_of(map, edge), 1, 1e-9);
}

TEST(PlacedGraphs, ToriHaveNoBorder) {
  for (const auto& [rows, cols] : {std::pair{3, 3}, {4, 8}, {12, 12}, {14, 14}, {15, 20}}) {
    const GraphMap map = torus_map(rows, cols);
    EXPECT_EQ(map.graph.edge_count(), 2 * rows * cols);
    EXPECT_THAT(degrees_of(map), ElementsAre(Pair(4, rows * cols)));
    EXPECT_TRUE(has_one_part(map));
    EXPECT_EQ(different_places(map), static_cast<std::size_t>(rows) * cols) << rows << " by " << cols;
  }
  EXPECT_EQ(torus_map(1, 1).graph.edge_count(), 0);
  EXPECT_EQ(torus_map(1, 5).graph.edge_count(), 5);
}

TEST(PlacedGraphs, BalancedTreesAreFilledLevelByLevel) {
  const GraphMap whole = balanced_tree_map(1 + 3 + 9 + 27, 3);
  EXPECT_EQ(whole.graph.edge_count(), 39);
  EXPECT_THAT(degrees_of(whole), ElementsAre(Pair(1, 27), Pair(3, 1), Pair(4, 12)));
  EXPECT_EQ(different_places(whole), 40u);
  const Point last = whole.places.points[39];
  EXPECT_NEAR(std::hypot(last.x, last.y), 3, 1e-5) << "the depth is the distance from the root";

  const GraphMap part = balanced_tree_map(9, 2);
  EXPECT_TRUE(has_one_part(part));
  EXPECT_THAT(part.graph.neighbours(3), ElementsAre(1, 7, 8));
  EXPECT_THAT(degrees_of(part), ElementsAre(Pair(1, 5), Pair(2, 1), Pair(3, 3)));
}

TEST(PlacedGraphs, CavesAreCliquesInARing) {
  const GraphMap map = caveman_map(12, 3);
  EXPECT_EQ(map.graph.edge_count(), 3 * 6);
  EXPECT_TRUE(has_one_part(map));
  EXPECT_THAT(map.graph.neighbours(0), ElementsAre(2, 3, 11));
  EXPECT_THAT(map.graph.neighbours(1), ElementsAre(2, 3));
  EXPECT_THAT(map.graph.neighbours(4), ElementsAre(3, 6, 7));
  EXPECT_THAT(degrees_of(map), ElementsAre(Pair(2, 3), Pair(3, 6), Pair(4, 3)));
  EXPECT_EQ(different_places(map), 12u);

  const GraphMap uneven = caveman_map(11, 3);  // of 4, 4 and 3
  EXPECT_EQ(uneven.graph.node_count(), 11);
  EXPECT_EQ(uneven.graph.edge_count(), 6 + 6 + 3);
  EXPECT_TRUE(has_one_part(uneven));
  EXPECT_TRUE(has_one_part(caveman_map(6, 2)));
  EXPECT_EQ(caveman_map(5, 1).graph.edge_count(), 10);
}

TEST(PlacedGraphs, RoadsCostAtLeastTheirLength) {
  Rng rng(1);
  const GraphMap map = road_map(40, 40, 0.7, true, rng);
  EXPECT_TRUE(has_one_part(map));
  EXPECT_GT(map.graph.node_count(), 1400);
  EXPECT_LT(map.graph.node_count(), 1600) << "some crossings are cut off";
  ASSERT_EQ(map.places.points.size(), static_cast<std::size_t>(map.graph.node_count()));
  EXPECT_EQ(map.places.unit, "m");
  int winding = 0;
  for (const Edge& edge : map.graph.edges()) {
    const double length = length_of(map, edge);
    EXPECT_EQ(edge.cost, std::floor(edge.cost));
    EXPECT_GE(edge.cost, length - 1e-6);
    EXPECT_LT(edge.cost, 2 * length + 1);
    EXPECT_LT(length, std::hypot(180, 180) + 1e-6);
    winding += edge.cost > length + 1;
  }
  const auto edges = static_cast<double>(map.graph.edge_count());
  EXPECT_NEAR(winding / edges, 1.0 / 7, 0.03);
  EXPECT_NEAR(edges / map.graph.node_count(), 2 * 0.7 + 0.05, 0.08);
}

TEST(PlacedGraphs, RoadsAreTheSameWithAndWithoutLengths) {
  Rng rng(2);
  Rng same(2);
  Rng other(3);
  const GraphMap plain = road_map(9, 9, 0.7, false, rng);
  const GraphMap with_lengths = road_map(9, 9, 0.7, true, same);
  EXPECT_FALSE(plain.graph.weighted());
  EXPECT_TRUE(with_lengths.graph.weighted());
  EXPECT_EQ(plain.places.points, with_lengths.places.points);
  EXPECT_EQ(plain.graph.edge_count(), with_lengths.graph.edge_count());
  EXPECT_NE(road_map(9, 9, 0.7, false, other).places.points, plain.places.points);
  EXPECT_EQ(road_map(4, 5, 0, false, other).graph.node_count(), 1);
}

TEST(PlacedGraphs, AreTheSameWhenShuffled) {
  Rng rng(4);
  const GraphMap map = road_map(8, 8, 0.75, true, rng);
  const GraphMap mixed = shuffled(map, rng);
  EXPECT_NE(mixed.places.points, map.places.points);
  EXPECT_EQ(drawn_edges(mixed), drawn_edges(map));
  EXPECT_EQ(mixed.places.unit, "m");
  std::map<NodeId, int> numbers;  // which ones the first node gets
  for (int i = 0; i < 900; ++i) {
    const std::vector<Point> points = shuffled(ladder_map(3), rng).places.points;
    ++numbers[static_cast<NodeId>(std::ranges::find(points, Point{0, 0}) - points.begin())];
  }
  ASSERT_EQ(numbers.size(), 6u);
  for (const auto& [number, times] : numbers) EXPECT_NEAR(times, 150, 45) << number;
}

}  // namespace
}  // namespace graphdrl
