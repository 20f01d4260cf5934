#include "graphdrl/env/graph_episodes.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// 0 - 1 - 2 - 3, and 1 - 3; edges cost 4 in the mean, nodes are worth 2.
World kite() {
  const std::vector<Edge> edges = {{0, 1, 2}, {1, 2, 4}, {2, 3, 4}, {1, 3, 6}};
  return World("kite", Graph::from_edges(4, edges), std::vector<bool>(4), {}, {1, 2, 4, 1});
}

float node(GraphEpisodes& episodes, NodeId row, GraphNodeFeature feature) {
  return episodes.observation_of(
      0)[static_cast<std::size_t>(row) * kFlatGraphNodeFeatureCount + static_cast<std::size_t>(feature)];
}
float action(GraphEpisodes& episodes, int nodes, int row, GraphActionFeature feature) {
  return episodes.observation_of(
      0)[static_cast<std::size_t>(nodes) * kFlatGraphNodeFeatureCount +
         static_cast<std::size_t>(row) * kGraphActionFeatureCount + static_cast<std::size_t>(feature)];
}
void take_action(GraphEpisodes& episodes, std::int64_t action) {
  episodes.step({&action, 1});
}
const bool kAll[] = {true};

TEST(GraphEpisodes, ShowsNodesAndNeighboursByName) {
  GraphEpisodes episodes({.world = kite(), .budget = Budget::parse("8"), .start = 1});
  episodes.reset(kAll);
  EXPECT_THAT(episodes.targets(), ElementsAre(0, 2, 3));
  EXPECT_THAT(episodes.action_masks(), Each(true));
  take_action(episodes, 0);
  EXPECT_EQ(episodes.rewards()[0], 0.1);
  EXPECT_THAT(episodes.targets(), ElementsAre(1, kNoNode, kNoNode));
  EXPECT_THAT(episodes.action_masks(), ElementsAre(true, false, false));
  for (NodeId n = 0; n < 4; ++n) {
    EXPECT_EQ(node(episodes, n, GraphNodeFeature::kOpen), 1);
    EXPECT_EQ(node(episodes, n, GraphNodeFeature::kVisited), n < 2);
    EXPECT_EQ(node(episodes, n, GraphNodeFeature::kCurrent), n == 0);
  }
  EXPECT_EQ(node(episodes, 2, GraphNodeFeature::kPrize), 4 / 2.0f / 8);
  EXPECT_EQ(action(episodes, 4, 0, GraphActionFeature::kLegal), 1);
  EXPECT_EQ(action(episodes, 4, 0, GraphActionFeature::kVisited), 1);
  EXPECT_EQ(action(episodes, 4, 0, GraphActionFeature::kCost), 2 / 4.0f / 8);
  EXPECT_EQ(action(episodes, 4, 0, GraphActionFeature::kPrize), 2 / 2.0f / 8);
  EXPECT_EQ(action(episodes, 4, 0, GraphActionFeature::kUnvisitedNeighbours), 2 / 8.0f);
  EXPECT_EQ(action(episodes, 4, 1, GraphActionFeature::kCost), 0) << "no such neighbour";
  EXPECT_THAT(episodes.observations().last(kGraphFeatureCount), ElementsAre(1 - 2 / 8.0f, 2 / 4.0f));
}

TEST(GraphEpisodes, MasksWhatCannotBePaidForAndChargesMaskedActions) {
  GraphEpisodes episodes({.world = kite(), .budget = Budget::parse("5"), .start = 1});
  episodes.reset(kAll);
  EXPECT_THAT(episodes.action_masks(), ElementsAre(true, true, false));
  take_action(episodes, 2);  // costs a mean edge, 4
  EXPECT_EQ(episodes.rewards()[0], -0.5);
  EXPECT_EQ(episodes.positions()[0], 1);
  EXPECT_EQ(episodes.episode(0).spent(), 4);
  EXPECT_TRUE(episodes.terminated()[0]) << "no edge costs 1";
  EXPECT_THAT(error_of([&] { take_action(episodes, 0); }), HasSubstr("the episode is over"));
}

TEST(GraphEpisodes, KeepsTheWayBack) {
  GraphEpisodes episodes(
      {.world = kite(), .budget = Budget::parse("9"), .start = 1, .episode = {.end = End::at_start()}});
  episodes.reset(kAll);
  EXPECT_THAT(episodes.action_masks(), ElementsAre(true, true, false)) << "3 costs 6, and 6 back";
}

TEST(GraphEpisodes, GainsTheShareOfPrizesAndEndsWithEverything) {
  GraphEpisodes episodes(
      {.world = kite(), .budget = Budget::parse("99"), .start = 0, .episode = {.reward = RewardKind::kCoverageGain}});
  episodes.reset(kAll);
  for (const auto& [move, gain] : {std::pair(0, 2 / 8.0), {1, 4 / 8.0}, {1, 1 / 8.0}}) {
    EXPECT_FALSE(episodes.terminated()[0]);
    take_action(episodes, move);
    EXPECT_EQ(episodes.rewards()[0], gain);
  }
  EXPECT_TRUE(episodes.terminated()[0]);
  EXPECT_FALSE(episodes.truncated()[0]);
}

TEST(GraphEpisodes, AreTruncatedWhereFreeMovesGoRound) {
  const std::vector<Edge> edges = {{0, 1, 0}, {1, 2, 7}};
  const World world("free", Graph::from_edges(3, edges), std::vector<bool>(3));
  GraphEpisodes episodes({.world = world, .budget = Budget::parse("3"), .start = 0});
  episodes.reset(kAll);
  int steps = 0;
  for (; !episodes.over(0); ++steps) {
    ASSERT_LT(steps, 1000);
    take_action(episodes, 0);
  }
  EXPECT_TRUE(episodes.truncated()[0]);
  EXPECT_FALSE(episodes.terminated()[0]);
}

TEST(GraphEpisodes, AreGraphsToo) {
  GraphEpisodes episodes({.world = kite(), .budget = Budget::parse("5"), .start = 1});
  episodes.reset(kAll);
  const GraphObservation graph = episodes.graph(0);
  EXPECT_THAT(graph.links, ElementsAre(0, 1, 1, 0, 1, 2, 1, 3, 2, 1, 2, 3, 3, 1, 3, 2));
  EXPECT_THAT(graph.costs, ElementsAre(0.5, 0.5, 1, 1.5, 1, 1, 1.5, 1));
  for (NodeId n = 0; n < 4; ++n) {
    const auto at = [&](GraphNodeFeature feature) {
      return graph.nodes[static_cast<std::size_t>(n) * kGraphNodeFeatureCount + static_cast<std::size_t>(feature)];
    };
    EXPECT_EQ(at(GraphNodeFeature::kCurrent), n == 1);
    EXPECT_EQ(at(GraphNodeFeature::kLegal), n == 0 || n == 2);
    EXPECT_EQ(at(GraphNodeFeature::kBudgetLeft), 1);
  }
}

TEST(GraphEpisodes, OfRandomWorldsHaveANewOneEach) {
  GraphEpisodes episodes({.budget = Budget::parse("1.1x"), .family = {.family = "tree", .size = 9}});
  EXPECT_THAT(error_of([&] { episodes.episode(0); }), HasSubstr("no episode yet"));
  episodes.seed(0, 3);
  episodes.reset(kAll);
  const World first = episodes.episode(0).world();
  episodes.reset(kAll);
  EXPECT_FALSE(episodes.episode(0).world() == first);
  EXPECT_EQ(episodes.targets().size(), 8U);
  EXPECT_THAT(error_of([&] { episodes.reset(kAll, 0); }), HasSubstr("no start to choose"));
}

TEST(GraphEpisodes, RefuseWhatDoesNotFit) {
  const auto error_for = [](EpisodesOptions options, int neighbours) {
    return error_of([&] { GraphEpisodes(options, neighbours).reset(kAll); });
  };
  EXPECT_THAT(error_for({.world = kite(), .start = 1}, 2), HasSubstr("at most max_neighbours = 2"));
  EXPECT_THAT(error_for({.world = kite(), .start = 9}, 0), HasSubstr("start outside the world"));
  EXPECT_THAT(error_for({.world = kite(), .count = 0}, 0), HasSubstr("bad number of environments"));
  EXPECT_THAT(error_for({.family = {.family = "forest", .size = 9}}, 0), HasSubstr("no such family"));
}

}  // namespace
}  // namespace graphdrl
