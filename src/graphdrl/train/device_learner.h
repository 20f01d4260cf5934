// A learner on any device of LibTorch, of LibTorch's operators alone.
#pragma once

#include "graphdrl/train/adam.h"
#include "graphdrl/train/composed_network.h"
#include "graphdrl/train/learner.h"

namespace graphdrl {

class DeviceLearner final : public Learner {
 public:
  DeviceLearner(torch::Device device, const LearnerOptions& options, Rng& rng);

  double learn(const Minibatch& batch, Rng& rng) override;
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override;
  LearnerState state() const override;
  void set_state(const LearnerState& state) override;

 private:
  const EdgeIndex& edges_of(const GraphBatch& batch);
  torch::Tensor to_device(const std::vector<float>& values, std::vector<std::int64_t> shape) const;

  torch::Device device_;
  LearnerOptions options_;
  AdamOptions adam_;
  std::int64_t adam_steps_ = 0;
  torch::Tensor values_;         // [all]
  torch::Tensor target_values_;  // [all]
  torch::Tensor gradients_;      // [trainable], as the moments
  torch::Tensor first_;
  torch::Tensor second_;
  NamedTensors online_;
  NamedTensors target_;
  std::vector<const Graph*> edges_graphs_;  // the batch that edges_ is of: the next one is mostly of the same graphs
  EdgeIndex edges_{};
};

}  // namespace graphdrl
