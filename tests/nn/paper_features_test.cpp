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

// The nodes with the feature wall, one row of the map per line.
std::string walls_of(const World& world, PaperWall wall) {
  const PaperFeatureEncoder encoder(world, wall);
  std::vector<float> features(static_cast<std::size_t>(world.node_count()) * kPaperFeatureCount);
  encoder.begin(0, features);
  std::string text;
  for (NodeId node = 0; node < world.node_count(); ++node) {
    const Cell cell = world.map()->cell(node);
    const std::size_t row = static_cast<std::size_t>(node) * kPaperFeatureCount;
    const float value = features[row + static_cast<std::size_t>(PaperFeature::kWall)];
    EXPECT_TRUE(value == 0 || value == 1);
    text += value == 1 ? 'w' : '.';
    if (cell.col + 1 == world.map()->cols) text += '\n';
  }
  return text;
}

World open_world(int rows, int cols) {
  std::string map;
  for (int row = 0; row < rows; ++row) map += std::string(static_cast<std::size_t>(cols), '.') + '\n';
  return grid_world(map);
}

TEST(Features, WallIsTheBorderOfTheMap) {
  EXPECT_EQ(walls_of(open_world(5, 5), PaperWall::kBorder),
            "wwwww\n"
            "w...w\n"
            "w...w\n"
            "w...w\n"
            "wwwww\n");
  EXPECT_EQ(walls_of(open_world(3, 11), PaperWall::kBorder),
            "wwwwwwwwwww\n"
            "w.........w\n"
            "wwwwwwwwwww\n");
}

TEST(Features, WallOfTheAuthorsCodeIsRowsAndColumns0And9) {
  EXPECT_EQ(walls_of(open_world(5, 5), PaperWall::kZeroOrNine),
            "wwwww\n"
            "w....\n"
            "w....\n"
            "w....\n"
            "w....\n");
  EXPECT_EQ(walls_of(open_world(3, 11), PaperWall::kZeroOrNine),
            "wwwwwwwwwww\n"
            "w........w.\n"
            "w........w.\n");
  EXPECT_EQ(walls_of(open_world(11, 3), PaperWall::kZeroOrNine),
            "www\n"
            "w..\nw..\nw..\nw..\nw..\nw..\nw..\nw..\n"
            "www\n"
            "w..\n");
  // On 10×10 the two are one.
  const World ten = open_world(10, 10);
  const std::string inner = "w........w\n";
  std::string expected = "wwwwwwwwww\n";
  for (int row = 1; row < 9; ++row) expected += inner;
  expected += "wwwwwwwwww\n";
  EXPECT_EQ(walls_of(ten, PaperWall::kZeroOrNine), expected);
  EXPECT_EQ(walls_of(ten, PaperWall::kBorder), expected);
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
