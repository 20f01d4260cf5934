#include "graphdrl/env/unknown_episodes.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// 0 - 1 - 2 - 3, and 1 - 3; nodes are worth 2 in the mean.
World unknown_kite() {
  const std::vector<Edge> edges = {{0, 1, 2}, {1, 2, 4}, {2, 3, 4}, {1, 3, 6}};
  return World("kite", Graph::from_edges(4, edges), std::vector<bool>(4), {}, {1, 2, 4, 1});
}

World unknown_path(int nodes) {
  std::vector<Edge> edges;
  for (NodeId node = 1; node < nodes; ++node) edges.push_back({node - 1, node});
  return World("path", Graph::from_edges(nodes, edges), std::vector<bool>(nodes));
}

EpisodesOptions unknown(const World& world, const char* budget, NodeId start, EpisodeOptions episode = {}) {
  episode.reveal = Reveal::parse("edges");
  return {.world = world, .budget = Budget::parse(budget), .start = start, .episode = episode};
}

float row_value(UnknownEpisodes& episodes, int row, UnknownNodeFeature feature) {
  return episodes.observation_of(
      0)[static_cast<std::size_t>(row) * kFlatUnknownNodeFeatureCount + static_cast<std::size_t>(feature)];
}

// Where actions lead, in the world's numbers.
std::vector<NodeId> world_targets(UnknownEpisodes& episodes) {
  std::vector<NodeId> nodes;
  for (const std::int64_t target : episodes.targets()) {
    nodes.push_back(episodes.episode(0).in_world(static_cast<NodeId>(target)));
  }
  return nodes;
}

void take_visit(UnknownEpisodes& episodes, std::int64_t action) {
  episodes.step({&action, 1});
}
const bool kBegin[] = {true};

TEST(UnknownEpisodes, ShowsWhatIsKnownByName) {
  UnknownEpisodes episodes(unknown(unknown_kite(), "20", 1, {.reward = RewardKind::kCoverageGain}), 4);
  episodes.reset(kBegin);
  EXPECT_THAT(world_targets(episodes), ElementsAre(0, 2, 3, kNoNode));
  EXPECT_THAT(episodes.action_masks(), ElementsAre(true, true, true, false));
  EXPECT_EQ(episodes.seen()[0], 4);
  using Feature = UnknownNodeFeature;
  EXPECT_EQ(row_value(episodes, 0, Feature::kAction), 1);
  EXPECT_EQ(row_value(episodes, 3, Feature::kAction), 0);
  EXPECT_EQ(row_value(episodes, 1, Feature::kFrontier), 1);
  EXPECT_EQ(row_value(episodes, 1, Feature::kPrize), 4 / 2.0f / 8);
  EXPECT_EQ(row_value(episodes, 1, Feature::kDegree), 1 / 8.0f) << "the edge to 3 is not known yet";
  EXPECT_EQ(row_value(episodes, 0, Feature::kDistance), 0.5f / 8.5f) << "2 of 4, the mean of the edges known";
  EXPECT_EQ(row_value(episodes, 0, Feature::kUnseenFor), 0);

  take_visit(episodes, 2);
  EXPECT_EQ(episodes.rewards()[0], 1 / 8.0);
  EXPECT_EQ(episodes.visited()[0], 2);
  EXPECT_THAT(world_targets(episodes), ElementsAre(2, 0, kNoNode, kNoNode));
  EXPECT_EQ(row_value(episodes, 0, Feature::kDegree), 2 / 8.0f);
  EXPECT_EQ(row_value(episodes, 0, Feature::kVisitedNeighbours), 2 / 8.0f);
  EXPECT_EQ(row_value(episodes, 0, Feature::kUnseenFor), 0);
  EXPECT_EQ(row_value(episodes, 1, Feature::kDistance), 2 / 10.0f) << "8, through 1";
  EXPECT_EQ(row_value(episodes, 1, Feature::kUnseenFor), 1 / 9.0f);
  EXPECT_THAT(episodes.observations().last(kUnknownFeatureCount), ElementsAre(1 - 6 / 20.0f, 3.5f / 11.5f));

  take_visit(episodes, 1);
  EXPECT_EQ(episodes.episode(0).spent(), 14);
  EXPECT_THAT(episodes.episode(0).walk_in_world(), ElementsAre(1, 3, 1, 0));
  EXPECT_THAT(world_targets(episodes), ElementsAre(2, kNoNode, kNoNode, kNoNode)) << "2 + 4 of the 6 that are left";
  take_visit(episodes, 0);
  EXPECT_TRUE(episodes.terminated()[0]);
}

TEST(UnknownEpisodes, GivesTheGraphKnown) {
  UnknownEpisodes episodes(unknown(unknown_path(4), "9", 1), 1);
  episodes.reset(kBegin);
  const GraphObservation seen = episodes.graph(0);
  EXPECT_EQ(seen.nodes.size(), 3U * kUnknownNodeFeatureCount) << "node 3 is not seen yet";
  EXPECT_EQ(seen.links.size(), 2U * 4);
  const auto value = [&](NodeId node, UnknownNodeFeature feature) {
    return seen.nodes[static_cast<std::size_t>(node) * kUnknownNodeFeatureCount + static_cast<std::size_t>(feature)];
  };
  const auto target = static_cast<NodeId>(episodes.targets()[0]);
  EXPECT_EQ(value(0, UnknownNodeFeature::kCurrent), 1);
  EXPECT_EQ(value(0, UnknownNodeFeature::kVisited), 1);
  EXPECT_EQ(value(0, UnknownNodeFeature::kDistance), 0);
  EXPECT_EQ(value(target, UnknownNodeFeature::kAction), 1);
  EXPECT_EQ(value(3 - target, UnknownNodeFeature::kAction), 0) << "the mask has room for one";
  EXPECT_EQ(value(3 - target, UnknownNodeFeature::kDistance), 1 / 9.0f);
  EXPECT_EQ(value(target, UnknownNodeFeature::kBudgetLeft), 1);
}

TEST(UnknownEpisodes, GainsWhatIsSeenWhereThatCounts) {
  UnknownEpisodes episodes(
      unknown(unknown_path(4), "9", 0, {.reward = RewardKind::kCoverageGain, .score = Score::kSeen}), 3);
  episodes.reset(kBegin);
  EXPECT_EQ(episodes.seen()[0], 2);
  for (const double gain : {0.25, 0.25, 0.0}) {
    EXPECT_FALSE(episodes.terminated()[0]);
    take_visit(episodes, 0);
    EXPECT_EQ(episodes.rewards()[0], gain);
  }
  EXPECT_TRUE(episodes.terminated()[0]);
}

TEST(UnknownEpisodes, KeepsTheWayBackAndChargesMaskedActions) {
  UnknownEpisodes episodes(unknown(unknown_kite(), "9", 1, {.end = End::at_start()}), 3);
  episodes.reset(kBegin);
  EXPECT_THAT(world_targets(episodes), ElementsAre(0, 2, kNoNode)) << "3 costs 6, and 6 back";
  take_visit(episodes, 2);  // a mean edge of those known, 4
  EXPECT_EQ(episodes.rewards()[0], -0.5);
  EXPECT_EQ(episodes.episode(0).spent(), 4);
  EXPECT_THAT(world_targets(episodes), ElementsAre(0, kNoNode, kNoNode));
}

TEST(UnknownEpisodes, NumbersNodesAnewInEachEpisode) {
  std::vector<Edge> edges;
  for (NodeId leaf = 1; leaf < 20; ++leaf) edges.push_back({0, leaf});
  const World star("star", Graph::from_edges(20, edges), std::vector<bool>(20));
  UnknownEpisodes episodes(unknown(star, "9", 0), 19);
  episodes.seed(0, 7);
  episodes.reset(kBegin);
  const std::vector<NodeId> first = world_targets(episodes);
  episodes.reset(kBegin);
  EXPECT_NE(world_targets(episodes), first);
  episodes.seed(0, 7);
  episodes.reset(kBegin);
  EXPECT_EQ(world_targets(episodes), first);
}

TEST(UnknownEpisodes, RefusesAMapThatIsKnown) {
  EXPECT_THAT(error_of([] { UnknownEpisodes({.world = unknown_path(2), .budget = Budget(3)}, 4); }),
              HasSubstr("bad reveal"));
}

}  // namespace
}  // namespace graphdrl
