// Trainings on several ranks.
#include <gmock/gmock.h>

#include <atomic>

#include "ranks_support.h"
#include "train/training.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

class TrainingOnRanksThread : public ::testing::TestWithParam<TrainOptions> {};

INSTANTIATE_TEST_SUITE_P(, TrainingOnRanksThread, ::testing::Values(short_explorer(), short_online()),
                         [](const auto& test) { return test.param.reveal; });

TEST_P(TrainingOnRanksThread, EndsWithTheBytesOfOneRank) {
  const TemporaryFolder folder;
  const Bytes alone = train_in(folder / "alone", GetParam());
  for (const int size : {2, 3}) {
    const RunDirectory run(folder / std::to_string(size));
    on_ranks(size,
             [&](Ranks& ranks) { EXPECT_TRUE(train(*Trainer::start(GetParam(), run, kCpuLearners, {}, ranks))); });
    EXPECT_TRUE(bytes_of(run) == alone) << size;
  }
}

// Each session is stopped by another rank, and has another number of ranks.
TEST_P(TrainingOnRanksThread, GoesOnOnAnotherNumberOfRanks) {
  const TemporaryFolder folder;
  const Bytes alone = train_in(folder / "alone", GetParam());
  const RunDirectory run(folder / "pieces");
  on_ranks(2, [&](Ranks& ranks) { Trainer::start(GetParam(), run, kCpuLearners, {}, ranks); });
  std::atomic<bool> finished = false;
  int sessions = 0;
  for (; !finished; ++sessions) {
    const int size = 1 + sessions % 3;
    on_ranks(size, [&](Ranks& ranks) {
      const auto trainer = Trainer::resume(run, kCpuLearners, ranks);
      int asked = 0;
      const bool stops = ranks.rank() == size - 1;
      if (train(*trainer, [&] { return stops && ++asked > 30; })) finished = true;
    });
    ASSERT_LT(sessions, 100);
  }
  EXPECT_GT(sessions, 1);
  EXPECT_TRUE(bytes_of(run) == alone);
}

TEST(TrainingOnRanks, EndsEverywhereWhereTheFolderHoldsARun) {
  const TemporaryFolder folder;
  const RunDirectory run(folder / "run");
  Trainer::start(short_explorer(), run);
  EXPECT_THAT(error_of([&] {
                on_ranks(2, [&](Ranks& ranks) { Trainer::start(short_explorer(), run, kCpuLearners, {}, ranks); });
              }),
              HasSubstr("holds a run already"));
}

}  // namespace
}  // namespace graphdrl
