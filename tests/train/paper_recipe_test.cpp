#include <gtest/gtest.h>

#include <cmath>

#include "train/training.h"

namespace graphdrl {
namespace {

TEST(PaperRecipe, RemembersItsMaps) {
  const TemporaryFolder folder;
  TrainOptions options = short_paper();
  write_file(folder / "map.txt", "....\n.#..\n");
  options.maps = {(folder / "map.txt").string()};
  options.start = "1,2";
  const RunDirectory run(folder / "run");
  Trainer::start(options, run);
  write_file(folder / "map.txt", "gone");
  EXPECT_TRUE(train(*Trainer::resume(run)));
}

TEST(PaperEpsilon, RunsFromTheFirstEpisodeToTheLast) {
  EXPECT_DOUBLE_EQ(paper_epsilon(0, 10'000), std::exp(-0.1));
  EXPECT_DOUBLE_EQ(paper_epsilon(9'999, 10'000), std::exp(-3.0));
  EXPECT_DOUBLE_EQ(paper_epsilon(1, 3), std::exp(-1.55));
  EXPECT_DOUBLE_EQ(paper_epsilon(0, 1), std::exp(-0.1));
}

}  // namespace
}  // namespace graphdrl
