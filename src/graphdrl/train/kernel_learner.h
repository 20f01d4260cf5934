// The learner on the kernels of nn/, on the CPU.
#pragma once

#include <vector>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/learner.h"
#include "graphdrl/train/q_network.h"

namespace graphdrl {

// The online and the target network and the optimiser. Everything it does is the same for any number of threads.
class KernelLearner final : public Learner {
 public:
  // Initialises the online network from rng and copies it to the target.
  KernelLearner(const LearnerOptions& options, Rng& rng);

  double learn(const Minibatch& batch, Rng& rng) override;
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override {
    online_.q_values(batch, x, q);
  }
  LearnerState state() const override;
  void set_state(const LearnerState& state) override;

  // The loss [paper, eq. 5]; its gradients stay in online().gradients(), not clamped yet.
  // keep_scale: [B, 256], see QNetwork::forward_train.
  double compute_gradients(const Minibatch& batch, std::span<const float> keep_scale);

  QNetwork& online() { return online_; }
  QNetwork& target() { return target_; }

 private:
  LearnerOptions options_;
  QNetwork online_;
  QNetwork target_;
  Adam adam_;
  std::vector<float> next_q_;       // [B, A]
  std::vector<float> next_online_;  // [B, A]
  std::vector<float> q_;            // [B, A]
};

}  // namespace graphdrl
