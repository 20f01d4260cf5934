// One learning step of DQN: targets, loss, Adam, soft update [paper, section 2 and Algorithm 1, lines 9 to 11].
#pragma once

#include <cstdint>
#include <vector>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/minibatch.h"
#include "graphdrl/train/q_network.h"

namespace graphdrl {

struct LearnerOptions {
  bool double_dqn = false;
  double discount = 0.99;       // alpha
  double learning_rate = 1e-3;  // Adam's
  double soft_update = 1e-3;    // beta
  double dropout = 0.5;
};

// The online and the target network and the optimiser. Everything it does is the same for any number of threads.
class Learner {
 public:
  // Initialises the online network from rng and copies it to the target.
  Learner(const LearnerOptions& options, Rng& rng);

  // One step; gives the loss before it. `rng` draws the dropout.
  double learn(const Minibatch& batch, Rng& rng);

  // The loss [paper, eq. 5]; its gradients stay in online().gradients(), not clamped yet.
  // keep_scale: [B, 256], see QNetwork::forward_train.
  double compute_gradients(const Minibatch& batch, const torch::Tensor& keep_scale);

  QNetwork& online() { return online_; }
  QNetwork& target() { return target_; }

  // For checkpoints: the arrays online.*, target.*, adam.*. Restoring throws Error where they do not fit.
  struct Packed {
    std::vector<std::int64_t> adam_step;  // [1]
  };
  void save(Packed& packed, std::vector<TensorView>& tensors);
  void restore(const Safetensors& file);

 private:
  LearnerOptions options_;
  QNetwork online_;
  QNetwork target_;
  Adam adam_;
  std::vector<float> next_q_;       // [B, A]
  std::vector<float> next_online_;  // [B, A]
};

}  // namespace graphdrl
