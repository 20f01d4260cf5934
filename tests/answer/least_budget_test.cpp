#include "graphdrl/answer/least_budget.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "graphdrl/base/random.h"
#include "graphdrl/io/readers.h"
#include "support.h"

namespace graphdrl {
namespace {

World graph_of(NodeId nodes, const std::vector<Edge>& edges, EdgeKind kind = EdgeKind::kUndirected) {
  return {"graph", Graph::from_edges(nodes, edges, kind), std::vector<bool>(nodes)};
}

TEST(LeastBudget, HoldsForItsStart) {
  const World path = graph_of(3, {{0, 1}, {0, 2}});
  EXPECT_EQ(least_budget(path, 0), 3);
  EXPECT_EQ(least_budget(path, 1), 2);
  EXPECT_EQ(least_budget(graph_of(3, {{0, 1}, {0, 2}}, EdgeKind::kDirected), 0), std::nullopt);
  EXPECT_EQ(least_budget(graph_of(2, {{0, 1}}, EdgeKind::kDirected), 1), std::nullopt);
  EXPECT_EQ(least_budget(graph_of(1, {}), 0), 0);
  EXPECT_EQ(least_budget(graph_of(3, {{0, 1, 0}, {1, 2, 0}, {2, 0, 0}}), 0), 0);
}

// Costs that are no whole numbers are told as they are, and never above the bound.
TEST(LeastBudget, IsRoundedDown) {
  EXPECT_EQ(least_budget(graph_of(3, {{0, 1, 2.5}, {1, 2, 1}}), 0), 3.5);
  EXPECT_EQ(least_budget(graph_of(3, {{0, 1, 0.1}, {1, 2, 0.2}}), 0), 0.3);
  EXPECT_EQ(least_budget(graph_of(3, {{0, 1, 1e10 / 3}, {1, 2, 1e-3}}), 0), 3333333330.0);
  EXPECT_EQ(least_budget(graph_of(2, {{0, 1, 2.0 / 3}}), 0), 0.666666666);
  EXPECT_EQ(least_budget(graph_of(2, {{0, 1, 8888887.5}}), 0), 8888887.5);
  EXPECT_EQ(least_budget(graph_of(2, {{0, 1, 1234567}}), 0), 1234567);
}

// Random places, some of them in the same spot, others far away; some are worth nothing.
World places(Rng& rng, const char* type, bool prizes) {
  const int count = 1 + static_cast<int>(rng.below(12));
  std::string text = fmt::format("TYPE: TSP\nDIMENSION: {}\nEDGE_WEIGHT_TYPE: {}\nNODE_COORD_SECTION\n", count, type);
  for (int i = 1; i <= count; ++i) {
    text += fmt::format("{} {} {}\n", i, rng.below(6) + (i % 5 == 0 ? 30 : 0), rng.below(6));
  }
  if (prizes) text += "NODE_SCORE_SECTION\n";
  for (int i = 1; prizes && i <= count; ++i) text += fmt::format("{} {}\n", i, rng.below(3));
  GraphMap map = parse_tsplib(text, "places");
  return {"places", map.graph, map.blocked, map.labels, map.prizes};
}

TEST(LeastBudget, OfCompleteGraphsIsThatOfTheBound) {
  Rng rng(1);
  for (int i = 0; i < 60; ++i) {
    for (const char* const type : {"EUC_2D", "CEIL_2D", "ATT"}) {
      const World world = places(rng, type, i % 2 == 1);
      const NodeId start = world.node_count() / 2;
      EXPECT_EQ(least_budget(world, start), least_budget_by_bounds(world, start)) << type << " " << i;
    }
  }
}

}  // namespace
}  // namespace graphdrl
