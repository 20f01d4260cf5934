#include "graphdrl/train/paper_recipe.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace graphdrl
