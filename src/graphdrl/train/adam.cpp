#include "graphdrl/train/adam.h"

#include <algorithm>
#include <cmath>

#include "graphdrl/base/parallel.h"
#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

constexpr std::size_t kBlock = 16'384;  // values

// Calls visit(begin, size) for every block of `count` values.
template <typename Visit>
void for_each_block(std::size_t count, const Visit& visit) {
  parallel_for(static_cast<int>((count + kBlock - 1) / kBlock), [&](int block) {
    const std::size_t begin = static_cast<std::size_t>(block) * kBlock;
    visit(begin, std::min(kBlock, count - begin));
  });
}

}  // namespace

void AdamState::step(std::span<const float> grad, double learning_rate, std::span<float> values) {
  ++steps;
  const auto t = static_cast<double>(steps);
  const auto rate = static_cast<float>(learning_rate / (1 - std::pow(kAdamBeta1, t)));
  const auto second_scale = static_cast<float>(1 / std::sqrt(1 - std::pow(kAdamBeta2, t)));
  for_each_block(values.size(), [&](std::size_t begin, std::size_t size) {
    adam_update(rate, second_scale, grad.data() + begin, exp_avg.data() + begin, exp_avg_sq.data() + begin,
                values.data() + begin, size);
  });
}

void soft_update(std::span<const float> online, double share, std::span<float> target) {
  for_each_block(target.size(), [&](std::size_t begin, std::size_t size) {
    move_towards(online.data() + begin, static_cast<float>(share), target.data() + begin, size);
  });
}

}  // namespace graphdrl
