#include "graphdrl/train/adam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "graphdrl/base/parallel.h"
#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

constexpr std::size_t kCount = 40'001;  // blocks, and a remainder

std::vector<float> random_values(Rng& rng) {
  std::vector<float> values(kCount);
  for (float& value : values) value = static_cast<float>(4 * rng.uniform() - 2);
  return values;
}

// The formula of Kingma and Ba [2015, algorithm 1] in double, on gradients cut to ±1.
TEST(Adam, IsItsFormulaWithClampedGradients) {
  Rng rng(1);
  std::vector<float> values = random_values(rng);
  std::vector<double> expected(values.begin(), values.end());
  std::vector<double> first(kCount);
  std::vector<double> second(kCount);
  AdamState adam(kCount);
  for (int t = 1; t <= 20; ++t) {
    const std::vector<float> grad = random_values(rng);
    set_threads(1 + t % 3);
    adam.step(grad, 3e-3, values);
    for (std::size_t i = 0; i < kCount; ++i) {
      const double g = std::clamp<double>(grad[i], -1, 1);
      first[i] = 0.9 * first[i] + 0.1 * g;
      second[i] = 0.999 * second[i] + 0.001 * g * g;
      const double m = first[i] / (1 - std::pow(0.9, t));
      const double v = second[i] / (1 - std::pow(0.999, t));
      expected[i] -= 3e-3 * m / (std::sqrt(v) + 1e-8);
    }
  }
  set_threads(1);
  EXPECT_EQ(adam.steps, 20);
  for (std::size_t i = 0; i < kCount; ++i) ASSERT_NEAR(values[i], expected[i], 1e-5) << i;
}

TEST(SoftUpdate, IsEquation6) {
  Rng rng(2);
  const std::vector<float> online = random_values(rng);
  const std::vector<float> before = random_values(rng);
  std::vector<float> target = before;
  soft_update(online, 0.3, target);
  for (std::size_t i = 0; i < kCount; ++i) ASSERT_NEAR(target[i], 0.3 * online[i] + 0.7 * before[i], 1e-6) << i;
}

}  // namespace
}  // namespace graphdrl
