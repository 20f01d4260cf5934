#include "graphdrl/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace graphdrl {
namespace {

TEST(Rng, IsXoshiro256StarStar) {
  // The first values of the reference implementation for the state 1, 2, 3, 4.
  Rng rng(Rng::State{1, 2, 3, 4});
  EXPECT_EQ(rng.next(), 11520u);
  EXPECT_EQ(rng.next(), 0u);
  EXPECT_EQ(rng.next(), 1509978240u);
  EXPECT_EQ(rng.next(), 1215971899390074240u);
}

TEST(Rng, GoesOnFromItsState) {
  Rng rng(7);
  rng.next();
  Rng copy(rng.state());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(copy.next(), rng.next());
}

TEST(DeriveSeed, GivesEveryPurposeItsOwn) {
  EXPECT_EQ(derive_seed(1, 2, 3), derive_seed(1, 2, 3));
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (std::uint64_t purpose = 0; purpose < 10; ++purpose) {
      for (std::uint64_t index = 0; index < 10; ++index) seeds.insert(derive_seed(seed, purpose, index));
    }
  }
  EXPECT_EQ(seeds.size(), 1000u);
}

TEST(Rng, BelowIsUniform) {
  Rng rng(1);
  std::array<int, 6> counts{};
  for (int i = 0; i < 60'000; ++i) ++counts[rng.below(6)];
  double chi_square = 0;  // 5 degrees of freedom: above 20.5 with probability 0.001
  for (const int count : counts) chi_square += (count - 10'000.0) * (count - 10'000.0) / 10'000.0;
  EXPECT_LT(chi_square, 20.5);
}

}  // namespace
}  // namespace graphdrl
