// Adam and the soft update, each one pass over flat buffers, spread over parallel_for.
//
// LibTorch's optimiser, one operator at a time on one thread, took three to four times as long (docs/performance.md); a
// test holds this one against it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace graphdrl {

struct AdamOptions {
  double learning_rate = 1e-3;
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-8;
  double clamp = 1.0;  // gradients are cut to [-clamp, clamp], element by element, as in the author's code
};

// The moments of a flat buffer of parameters.
class Adam {
 public:
  Adam(std::size_t count, const AdamOptions& options) : options_(options), first_(count), second_(count) {}

  // One step. REQUIRES: both as long as the moments.
  void step(std::span<const float> grad, std::span<float> values);

  void set_learning_rate(double rate) { options_.learning_rate = rate; }

  // For checkpoints.
  std::int64_t& steps() { return steps_; }
  std::vector<float>& first() { return first_; }
  std::vector<float>& second() { return second_; }
  std::int64_t steps() const { return steps_; }
  const std::vector<float>& first() const { return first_; }
  const std::vector<float>& second() const { return second_; }

 private:
  AdamOptions options_;
  std::int64_t steps_ = 0;
  std::vector<float> first_;   // mean of the gradients
  std::vector<float> second_;  // mean of their squares
};

// θ' ← share · θ + (1 - share) · θ' [paper, eq. 6]
void soft_update(std::span<const float> online, double share, std::span<float> target);

}  // namespace graphdrl
