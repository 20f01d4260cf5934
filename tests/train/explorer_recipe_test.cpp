#include <gmock/gmock.h>

#include "train/training.h"

namespace graphdrl {
namespace {

TEST(ExplorerRecipe, RefusesLessonsThatNoWalkHas) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  train(*Trainer::start(short_explorer(), run), [] { return true; });
  const std::string whole = read_file(run.checkpoint());
  constexpr std::int64_t kWild = 0x7f7f7f7f7f7f7f7f;
  for (const char* const name : {"replay.position", "replay.scope", "replay.label_count", "replay.next"}) {
    for (const std::int64_t value : {kWild, std::int64_t{-1}}) {
      write_file(run.checkpoint(), with_checksum(with_element(whole, name, 0, value)));
      EXPECT_THAT(error_of([&] { Trainer::resume(run); }), ::testing::HasSubstr("are damaged")) << name;
    }
  }
}

}  // namespace
}  // namespace graphdrl
