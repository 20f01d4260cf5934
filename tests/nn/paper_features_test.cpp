#include "graphdrl/nn/paper_features.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

std::vector<float> features_of(const Episode& episode) {
  std::vector<float> features(episode.visits().size() * kPaperFeatureCount);
  PaperFeatureEncoder(episode.world()).encode(episode.position(), std::span(episode.visits()), std::span(features));
  return features;
}

TEST(Features, AreThePapersSevenOnASmallGrid) {
  const World world = grid_world("...\n..#\n...\n");
  Episode episode(world, {});
  episode.reset(4);
  episode.step(0);  // left, to node 3
  episode.step(0);  // off the map: one more visit of node 3
  // clang-format off
  const std::vector<float> expected = {
      // x, y, obstacle, visits, wall, unvisited neighbours, current
      0, 0, 0, 0, 1, 1, 0,   // 0: neighbours 1 and 3
      0, 1, 0, 0, 1, 2, 0,   // 1: 0, 2, and 4, which is visited
      0, 2, 0, 0, 1, 2, 0,   // 2: 1 and the obstacle
      1, 0, 0, 2, 1, 2, 1,   // 3: 0, 6, and 4, which is visited
      1, 1, 0, 1, 0, 3, 0,   // 4: 1, 5 (an obstacle), 7, and 3, which is visited
      1, 2, 1, 0, 1, 2, 0,   // 5: 2, 8, and 4, which is visited
      2, 0, 0, 0, 1, 1, 0,   // 6: 7, and 3, which is visited
      2, 1, 0, 0, 1, 2, 0,   // 7: 6, 8, and 4, which is visited
      2, 2, 0, 0, 1, 2, 0};  // 8: 5 and 7
  // clang-format on
  EXPECT_EQ(features_of(episode), expected);
}

TEST(Features, KeptUpToDateAreThoseFromScratch) {
  Rng rng(11);
  for (int round = 0; round < 200; ++round) {
    const World world = random_world(rng, 1 + static_cast<int>(rng.below(6)), 1 + static_cast<int>(rng.below(6)), 0.3);
    const PaperFeatureEncoder encoder(world);
    Episode episode(world, {.budget = 30});
    const NodeId start = world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
    episode.reset(start);
    std::vector<float> features(episode.visits().size() * kPaperFeatureCount);
    encoder.begin(start, features);
    while (!episode.done()) {
      ASSERT_EQ(features, features_of(episode));
      const NodeId from = episode.position();
      const StepResult step = episode.step(static_cast<int>(rng.below(4)));
      encoder.update(from, episode.position(), step, features);
    }
    ASSERT_EQ(features, features_of(episode));
  }
}

TEST(Features, NeedAGrid) {
  const World world("graph", Graph::from_edges(2, {}), {false, false});
  EXPECT_NE(error_of([&] { PaperFeatureEncoder encoder(world); }), "");
}

}  // namespace
}  // namespace graphdrl
