// The learner on the kernels of nn/, on the CPU.
#pragma once

#include <utility>
#include <vector>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/paper_learner.h"
#include "graphdrl/train/paper_q_network.h"

namespace graphdrl {

// The online and the target network and the optimiser. Everything it does is the same for any number of threads.
class PaperKernelLearner final : public PaperLearner {
 public:
  // Initialises the online network from rng and copies it to the target.
  PaperKernelLearner(const PaperLearnerOptions& options, Rng& rng);

  void learn(const PaperMinibatch& batch, Rng& rng) override;
  std::vector<double> take_losses() override { return std::exchange(losses_, {}); }
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override {
    online_.q_values(batch, x, q);
  }
  PaperState state() const override;
  void set_state(const PaperState& state) override;

  // The loss [paper, eq. 5]; its gradients stay in online().gradients(), not clamped yet.
  // keep_scale: [B, 256], see PaperQNetwork::forward_train.
  double compute_gradients(const PaperMinibatch& batch, std::span<const float> keep_scale);

  PaperQNetwork& online() { return online_; }
  PaperQNetwork& target() { return target_; }

 private:
  PaperLearnerOptions options_;
  PaperQNetwork online_;
  PaperQNetwork target_;
  Adam adam_;
  std::vector<double> losses_;      // not taken yet
  std::vector<float> next_q_;       // [B, A]
  std::vector<float> next_online_;  // [B, A]
  std::vector<float> q_;            // [B, A]
};

}  // namespace graphdrl
