#include "graphdrl/nn/feature_episodes.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

// A path of `nodes` nodes.
World path(int nodes) {
  std::vector<Edge> edges;
  for (NodeId node = 1; node < nodes; ++node) edges.push_back({node - 1, node});
  return World("path", Graph::from_edges(nodes, edges), std::vector<bool>(nodes));
}

float feature(FirstVisitEpisodes& episodes, int action, FirstVisitFeature which) {
  return episodes.observation_of(
      0)[static_cast<std::size_t>(action) * kFirstVisitFeatureCount + static_cast<std::size_t>(which)];
}
void make_visit(FirstVisitEpisodes& episodes, std::int64_t action) {
  episodes.step({&action, 1});
}
const bool kTheOnlyOne[] = {true};

TEST(FirstVisitEpisodes, WalkThroughVisitedNodesToTheNextOne) {
  FirstVisitEpisodes episodes({.world = path(5), .budget = Budget::parse("5"), .start = 1}, 3);
  episodes.reset(kTheOnlyOne);
  EXPECT_THAT(episodes.targets(), ElementsAre(0, 2, kNoNode));
  EXPECT_THAT(episodes.action_masks(), ElementsAre(true, true, false));
  make_visit(episodes, 1);
  EXPECT_THAT(episodes.targets(), ElementsAre(3, 0, kNoNode)) << "nearest first";
  EXPECT_EQ(feature(episodes, 0, FirstVisitFeature::kExists), 1);
  EXPECT_EQ(feature(episodes, 0, FirstVisitFeature::kExplorer), 1 / 8.0f) << "the first feature is the cost";
  EXPECT_EQ(feature(episodes, 1, FirstVisitFeature::kExplorer), 2 / 8.0f);
  EXPECT_THAT(episodes.observation_of(0).last(kFirstVisitFeatureCount), Each(0.0f));
  make_visit(episodes, 1);
  EXPECT_THAT(episodes.episode(0).walk(), ElementsAre(1, 2, 1, 0));
  EXPECT_DOUBLE_EQ(episodes.rewards()[0], 0.1 - 0.1) << "back through 1, then 0";
  EXPECT_TRUE(episodes.terminated()[0]) << "3 costs 3, and 2 is left";
}

TEST(FirstVisitEpisodes, ChargeMaskedActions) {
  FirstVisitEpisodes episodes({.world = path(3), .budget = Budget::parse("1"), .start = 0}, 2);
  episodes.reset(kTheOnlyOne);
  make_visit(episodes, 1);
  EXPECT_EQ(episodes.rewards()[0], -0.5);
  EXPECT_TRUE(episodes.terminated()[0]);
}

TEST(FirstVisitEpisodes, KeepTheWayBack) {
  FirstVisitEpisodes episodes(
      {.world = path(5), .budget = Budget::parse("3"), .start = 1, .episode = {.end = End::at_start()}}, 2);
  episodes.reset(kTheOnlyOne);
  make_visit(episodes, 1);
  EXPECT_THAT(episodes.action_masks(), Each(false)) << "3 and back costs 3, and 2 is left";
  EXPECT_TRUE(episodes.terminated()[0]);
}

TEST(FirstVisitEpisodes, AreGraphsToo) {
  FirstVisitEpisodes episodes({.world = path(4), .budget = Budget::parse("9"), .start = 1}, 3);
  episodes.reset(kTheOnlyOne);
  const GraphObservation graph = episodes.graph(0);
  EXPECT_EQ(graph.nodes.size(), std::size_t{4} * kExplorerNodeFeatureCount);
  EXPECT_EQ(graph.links.size(), 2U * graph.costs.size());
  const auto rows = episodes.target_rows(0);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[2], kNoNode);
  constexpr std::size_t kCandidate = feature_column(kExplorerNodeFeatures, "candidate");
  for (const int action : {0, 1}) {
    EXPECT_EQ(graph.nodes[static_cast<std::size_t>(rows[action]) * kExplorerNodeFeatureCount + kCandidate], 1);
  }
}

// Of a first visit beyond the explorer's horizon nothing is seen; it can be made all the same.
TEST(FirstVisitEpisodes, GoFar) {
  constexpr int kNodes = 2 * kExplorerHorizon + 300;
  FirstVisitEpisodes episodes({.world = path(kNodes), .budget = Budget::parse("99999"), .start = kNodes / 2}, 1);
  episodes.reset(kTheOnlyOne);
  int steps = 0;
  bool unseen = false;
  for (; !episodes.over(0); ++steps) {
    unseen = unseen || feature(episodes, 0, FirstVisitFeature::kExplorer) == 0;
    make_visit(episodes, 0);
  }
  EXPECT_TRUE(unseen);
  EXPECT_EQ(steps, kNodes - 1);
  EXPECT_EQ(episodes.visited()[0], kNodes);
}

}  // namespace
}  // namespace graphdrl
