#include "graphdrl/env/world.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

// A diagonal step that passes a blocked corner is no edge of what is written.
TEST(World, IsWrittenWithoutDiagonalsPastObstacles) {
  const World world("corner", GridMap{.rows = 2, .cols = 2, .blocked = {false, false, true, false}, .diagonals = true});
  EXPECT_EQ(world.to_map().graph.index_of(0, 3), -1);
  EXPECT_EQ(world.to_map().graph.edge_count(), 2);
}

TEST(World, IsOneDescriptionOfAGraphAndBack) {
  const std::vector<Edge> edges = {{0, 1, 2}, {1, 1, 1}, {0, 1, 3}};
  GraphMap map{.graph = Graph::from_edges(3, edges),
               .blocked = {false, false, true},
               .labels = {"a", "b", "c"},
               .prizes = {1, 2, 3},
               .places = {.points = {{0, 0}, {1, 0}, {0, 1}}, .unit = "m"},
               .task = {.budget = 4, .start = 1}};
  map.multigraph = std::make_shared<const Multigraph>(Multigraph{.edges = edges, .labels = {"go", "stay", ""}});
  const World world("map", map);
  ASSERT_NE(world.multigraph(), nullptr);
  EXPECT_EQ(world.multigraph()->loops(), 1);
  EXPECT_EQ(world.multigraph()->parallel_edges(world.graph()), 1);
  const GraphMap back = world.to_map();
  EXPECT_EQ(back.graph.edge_count(), 1);
  EXPECT_EQ(back.blocked, map.blocked);
  EXPECT_EQ(back.labels, map.labels);
  EXPECT_EQ(back.prizes, map.prizes);
  EXPECT_EQ(back.places.unit, "m");
  EXPECT_EQ(back.places.points.size(), 3u);
  EXPECT_EQ(back.task.budget, 4);
  EXPECT_EQ(back.multigraph, map.multigraph);
}

TEST(World, RefusesPrizesWhoseSumOverflows) {
  const std::vector<Edge> edges = {{0, 1}};
  EXPECT_THAT(error_of([&] {
                World("rich", Graph::from_edges(2, edges), std::vector<bool>(2), {}, {1e308, 1e308});
              }),
              ::testing::HasSubstr("add up to more than a number holds"));
}

}  // namespace
}  // namespace graphdrl
