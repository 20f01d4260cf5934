// Adam and the soft update, each one pass over flat buffers, spread over parallel_for.
//
// LibTorch's optimiser, one operator at a time on one thread, took three to four times as long (docs/performance.md); a
// test holds this one against it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace graphdrl {

// The optimiser of a flat buffer, which is all that it remembers; under PyTorch's names.
struct AdamState {
  AdamState() = default;
  explicit AdamState(std::size_t count) : exp_avg(count), exp_avg_sq(count) {}

  // Takes a step. REQUIRES: both as long as the moments.
  void step(std::span<const float> grad, double learning_rate, std::span<float> values);

  std::vector<float> exp_avg;     // mean of the gradients
  std::vector<float> exp_avg_sq;  // mean of their squares
  std::int64_t steps = 0;
};

// θ' ← share · θ + (1 - share) · θ' [paper, eq. 6]
void soft_update(std::span<const float> online, double share, std::span<float> target);

}  // namespace graphdrl
