#include "graphdrl/graph/components.h"

#include <gmock/gmock.h>

#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

TEST(Components, StandInTheOrderOfTheirLowestNodes) {
  const std::vector<Edge> edges = {{4, 1}, {5, 2}, {2, 3}, {0, 1}};
  const Components parts = find_components(Graph::from_edges(6, edges), {true, false, false, false, false, false});
  EXPECT_THAT(parts.of, ElementsAre(Components::kNone, 0, 1, 1, 0, 1));
  EXPECT_THAT(parts.sizes, ElementsAre(2, 3));
  EXPECT_EQ(parts.largest(), 1);
  EXPECT_EQ(find_components(Graph::from_edges(1, {}), {true}).largest(), Components::kNone);
}

TEST(Components, AreJoinedWhicheverWayEdgesLead) {
  const std::vector<Edge> edges = {{2, 0}, {2, 1}};
  EXPECT_EQ(find_components(Graph::from_edges(3, edges, EdgeKind::kDirected), std::vector<bool>(3)).count(), 1);
}

TEST(Components, OfAMapAreThoseOfItsGraph) {
  Rng rng(1);
  for (int i = 0; i < 50; ++i) {
    GridMap map{.rows = 9, .cols = 7, .blocked = {}};
    for (int cell = 0; cell < 63; ++cell) map.blocked.push_back(rng.uniform() < 0.4);
    const Components of_map = find_components(map);
    const Components of_graph = find_components(Graph::grid(9, 7), map.blocked);
    EXPECT_EQ(of_map.of, of_graph.of);
    EXPECT_EQ(of_map.sizes, of_graph.sizes);
  }
}

}  // namespace
}  // namespace graphdrl
