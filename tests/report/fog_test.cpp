#include "graphdrl/report/fog.h"

#include <gmock/gmock.h>

#include "explored.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

std::vector<int> of_nodes(const Fog& fog, const World& world) {
  std::vector<int> steps;
  for (NodeId node = 0; node < world.node_count(); ++node) steps.push_back(fog.lifts_at(node));
  return steps;
}

std::vector<int> of_edges(const Fog& fog, const std::vector<Edge>& edges) {
  std::vector<int> steps;
  for (const Edge& edge : edges) steps.push_back(fog.lifts_at(edge));
  return steps;
}

const std::vector<Edge> kRing = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}};

TEST(Fog, LiftsWithTheEdgesThatVisitsShow) {
  const World world("ring", Graph::from_edges(5, kRing), std::vector<bool>(5));
  const Fog fog(explored(world, "edges", {0, 1}));
  EXPECT_THAT(of_nodes(fog, world), ElementsAre(0, 0, 1, -1, 0));
  EXPECT_THAT(of_edges(fog, kRing), ElementsAre(0, 1, -1, -1, 0));
  const Fog further(explored(world, "edges", {0, 1, 0, 4}));
  EXPECT_THAT(of_nodes(further, world), ElementsAre(0, 0, 1, 3, 0));
  EXPECT_THAT(of_edges(further, kRing), ElementsAre(0, 1, -1, 3, 0)) << "that from 2 to 3 leaves no node visited";
}

TEST(Fog, LiftsWithTheEndsOfAnEdgeWithinARadius) {
  const World world("ring", Graph::from_edges(5, kRing), std::vector<bool>(5));
  const Fog fog(explored(world, "radius:2", {0}));
  EXPECT_THAT(of_edges(fog, kRing), ElementsAre(0, 0, 0, 0, 0));
}

TEST(Fog, LiftsFromADirectedEdgeWithItsBegin) {
  const std::vector<Edge> edges = {{0, 1}, {2, 1}, {1, 2}};
  const World world("path", Graph::from_edges(3, edges, EdgeKind::kDirected), std::vector<bool>(3));
  EXPECT_THAT(of_edges(Fog(explored(world, "edges", {0, 1})), edges), ElementsAre(0, -1, 1));
}

TEST(Fog, LiftsFromObstaclesWithTheFirstNodeBesideThem) {
  const World grid = grid_world("...##\n.#..#\n....#\n");
  EXPECT_THAT(of_nodes(Fog(explored(grid, "edges", {0, 1})), grid),
              ElementsAre(0, 0, 1, 1, -1, 0, 0, -1, -1, -1, -1, -1, -1, -1, -1));
  const World graph("path", Graph::from_edges(3, std::vector<Edge>{{0, 1}, {1, 2}}), {false, true, true});
  EXPECT_THAT(of_nodes(Fog(explored(graph, "edges", {0})), graph), ElementsAre(0, 0, -1));
}

TEST(Fog, IsNotThereWhereTheMapWasKnown) {
  const World world("ring", Graph::from_edges(5, kRing), std::vector<bool>(5));
  const Task task(world, 0, 1);
  const Fog fog(Answer{.world = world, .task = task, .policy = "mine", .plan = plan_of_walk(task, {0, 1})});
  EXPECT_TRUE(fog.empty());
  EXPECT_THAT(of_nodes(fog, world), ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(of_edges(fog, kRing), ElementsAre(0, 0, 0, 0, 0));
}

}  // namespace
}  // namespace graphdrl
