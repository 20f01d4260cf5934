#include "graphdrl/graph/components.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace graphdrl {
namespace {

using ::testing::ElementsAre;

std::vector<NodeId> sorted(std::span<const NodeId> nodes) {
  std::vector<NodeId> result(nodes.begin(), nodes.end());
  std::sort(result.begin(), result.end());
  return result;
}

TEST(Blocks, HangFromTheirNodeNearestToTheRoot) {
  // A triangle 0 1 2, a bridge 2 - 3, and a square 3 4 5 6.
  const std::vector<Edge> edges = {{0, 1}, {1, 2}, {0, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {3, 6}};
  const Graph graph = Graph::from_edges(7, edges);
  const Blocks blocks(graph, 0, std::vector<bool>(7, true));
  ASSERT_EQ(blocks.count(), 3);
  EXPECT_EQ(blocks.root(0), 3);
  EXPECT_THAT(sorted(blocks.members(0)), ElementsAre(4, 5, 6));
  EXPECT_EQ(blocks.root(1), 2);
  EXPECT_THAT(blocks.members(1), ElementsAre(3));
  EXPECT_EQ(blocks.root(2), 0);
  EXPECT_THAT(sorted(blocks.members(2)), ElementsAre(1, 2));
}

TEST(Blocks, LeaveOutWhatIsOutOfReach) {
  const Graph path = Graph::grid(1, 4);
  const Blocks blocks(path, 1, {false, true, true, false});
  ASSERT_EQ(blocks.count(), 1);
  EXPECT_THAT(blocks.members(0), ElementsAre(2));
}

TEST(StrongComponents, AreNumberedAlongTheEdges) {
  // 0 <-> 1 -> 2 -> 3 -> 2, and 4, which cannot be reached.
  const std::vector<Edge> edges = {{0, 1}, {1, 0}, {1, 2}, {2, 3}, {3, 2}, {4, 0}};
  const Graph graph = Graph::from_edges(5, edges, EdgeKind::kDirected);
  EXPECT_THAT(strong_components(graph, 0, std::vector<bool>(5, true)), ElementsAre(0, 0, 1, 1, -1));
}

}  // namespace
}  // namespace graphdrl
