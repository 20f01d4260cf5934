#include "graphdrl/base/ranks.h"

#include <gmock/gmock.h>

#include <atomic>
#include <set>

#include "graphdrl/base/random.h"
#include "ranks_support.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

// The sum of 16 shards of three numbers each, whose order shows in the last digits.
std::vector<float> sum_on(Ranks& ranks) {
  ShardedSum shards(ranks, 16);
  std::vector<std::vector<float>> own;
  for (int i = 0; i < shards.shard_count(); ++i) {
    Rng rng(static_cast<std::uint64_t>(shards.first_shard() + i));
    auto& values = own.emplace_back();
    for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(rng.uniform()));
  }
  std::vector<float> sum(3);
  shards.sum(own, sum);
  return sum;
}

TEST(ShardedSumThread, IsTheSameOnAnyNumberOfRanks) {
  const std::vector<float> alone = sum_on(one_rank());
  double first = 0;
  for (std::uint64_t shard = 0; shard < 16; ++shard) first += static_cast<float>(Rng(shard).uniform());
  EXPECT_NEAR(alone[0], first, 1e-5);
  for (const int size : {1, 2, 3, 5, 16, 20}) {
    std::atomic<int> equal = 0;
    on_ranks(size, [&](Ranks& ranks) { equal += sum_on(ranks) == alone; });
    EXPECT_EQ(equal, size);
  }
}

TEST(RanksThread, GetEachTaskOnce) {
  std::mutex mutex;
  std::multiset<int> done;
  on_ranks(3, [&](Ranks& ranks) {
    const auto queue = ranks.hand_out(100);
    while (const auto task = queue->next()) {
      const std::lock_guard lock(mutex);
      done.insert(*task);
    }
  });
  EXPECT_EQ(done.size(), 100u);
  EXPECT_EQ(std::set<int>(done.begin(), done.end()).size(), 100u);
}

TEST(Ranks, GiveNoTaskOnceAQueueIsClosed) {
  const auto queue = one_rank().hand_out(3);
  EXPECT_EQ(queue->next(), 0);
  queue->close();
  EXPECT_EQ(queue->next(), std::nullopt);
}

TEST(RanksThread, RefuseWhatIsNotTheSame) {
  EXPECT_EQ(error_of([] { on_ranks(3, [](Ranks& ranks) { ranks.require_same("options", "a"); }); }), "");
  EXPECT_THAT(
      error_of([] { on_ranks(3, [](Ranks& ranks) { ranks.require_same("options", ranks.rank() == 2 ? "b" : "a"); }); }),
      HasSubstr("rank 2 has other options than rank 0"));
}

TEST(RanksThread, EndWhereTheFirstOneFails) {
  std::atomic<int> went_on = 0;
  EXPECT_EQ(error_of([&] {
              on_ranks(3, [&](Ranks& ranks) {
                ranks.on_first([] { throw Error({.what = "no"}); });
                ++went_on;
              });
            }),
            "no");
  EXPECT_EQ(went_on, 0);
}

}  // namespace
}  // namespace graphdrl
