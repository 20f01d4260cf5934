#include "graphdrl/nn/feature_episodes.h"

#include <gmock/gmock.h>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kRight = 2;

float feature(GridEpisodes& episodes, NodeId cell, PaperFeature which) {
  return episodes.observation_of(
      0)[static_cast<std::size_t>(cell) * kPaperFeatureCount + static_cast<std::size_t>(which)];
}

TEST(GridEpisodes, ShowTheFeaturesOfThePaper) {
  GridEpisodes episodes({.world = grid_world("..\n#.\n"), .budget = Budget::parse("2"), .start = 0});
  const bool all[] = {true};
  episodes.reset(all);
  EXPECT_THAT(episodes.action_masks(), Each(true));
  episodes.step({&kRight, 1});
  EXPECT_EQ(episodes.rewards()[0], 0.1);
  EXPECT_FALSE(episodes.over(0));
  episodes.step({&kRight, 1});  // off the map
  EXPECT_EQ(episodes.rewards()[0], -0.5);
  EXPECT_EQ(feature(episodes, 1, PaperFeature::kCurrent), 1);
  EXPECT_EQ(feature(episodes, 1, PaperFeature::kVisits), 2);
  EXPECT_EQ(feature(episodes, 2, PaperFeature::kObstacle), 1);
  EXPECT_EQ(feature(episodes, 3, PaperFeature::kUnvisitedNeighbours), 1) << "an obstacle counts";
  EXPECT_TRUE(episodes.truncated()[0]);
  EXPECT_FALSE(episodes.terminated()[0]);
  EXPECT_THAT(episodes.highest_features(), ElementsAre(1, 1, 1, 3, 1, 4, 1));
}

TEST(GridEpisodes, CanTerminateAtFullCoverage) {
  GridEpisodes episodes(
      {.world = grid_world(".."), .budget = Budget::parse("9"), .start = 0, .episode = {.end_at_full_coverage = true}});
  const bool all[] = {true};
  episodes.reset(all);
  episodes.step({&kRight, 1});
  EXPECT_EQ(episodes.rewards()[0], 1.1);
  EXPECT_TRUE(episodes.terminated()[0]);
  EXPECT_FALSE(episodes.truncated()[0]);
}

TEST(GridEpisodes, ShowNothingOfTheWorldBefore) {
  GridEpisodes episodes({.budget = Budget::parse("1x"), .family = {.family = "open", .size = 9}});
  const bool all[] = {true};
  for (int i = 0; i < 20; ++i) {
    episodes.reset(all);
    const auto cells = static_cast<std::size_t>(episodes.episode(0).world().node_count());
    EXPECT_THAT(episodes.observations().subspan(cells * kPaperFeatureCount), Each(0.0f));
  }
}

TEST(GridEpisodes, RefuseWhatDoesNotFit) {
  const World pair("pair", Graph::from_edges(2, std::vector<Edge>{{0, 1}}), std::vector<bool>(2));
  EXPECT_THAT(error_of([&] { GridEpisodes({.world = pair, .budget = Budget::parse("9")}); }), HasSubstr("grid"));
  EXPECT_THAT(error_of([] { GridEpisodes({.world = grid_world("..")}); }), HasSubstr("bad budget"));
}

// Random actions, and new episodes where one is over: the same one by one and side by side, for any number of threads.
TEST(GridEpisodes, StepAsIfEachWereAlone) {
  constexpr int kCount = 150;  // two blocks and a remainder
  constexpr int kSteps = 40;
  EpisodesOptions options{.world = grid_world("....\n.##.\n....\n"), .budget = Budget::parse("15"), .restarts = true};
  const auto walk = [&](GridEpisodes& episodes, int first) {
    std::vector<Rng> rngs;
    for (int i = 0; i < episodes.count(); ++i) {
      rngs.emplace_back(static_cast<std::uint64_t>(first + i));
      episodes.seed(i, static_cast<std::uint64_t>(first + i));
    }
    std::vector<std::int64_t> actions(rngs.size());
    for (int step = 0; step < kSteps; ++step) {
      std::ranges::transform(rngs, actions.begin(), [](Rng& rng) { return rng.below(4); });
      episodes.step(actions);
    }
  };
  std::vector<std::vector<NodeId>> expected;
  for (int i = 0; i < kCount; ++i) {
    GridEpisodes alone(options);
    walk(alone, i);
    expected.push_back(alone.episode(0).walk());
  }
  options.count = kCount;
  for (const int threads : {1, 2, 3}) {
    set_threads(threads);
    GridEpisodes episodes(options);
    walk(episodes, 0);
    for (int i = 0; i < kCount; ++i) ASSERT_EQ(episodes.episode(i).walk(), expected[i]) << threads << " threads, " << i;
  }
  set_threads(1);
}

}  // namespace
}  // namespace graphdrl
