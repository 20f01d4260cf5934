// A learner on any device of LibTorch, of LibTorch's operators alone. On a GPU, sums run in no fixed order: the same
// seed gives the same policy on the CPU only. REQUIRES: the graphs of its batches outlive it.
#pragma once

#include "graphdrl/train/adam.h"
#include "graphdrl/train/paper_learner.h"
#include "graphdrl/train/torch/paper_composed_network.h"

namespace graphdrl {

class PaperDeviceLearner final : public PaperLearner {
 public:
  PaperDeviceLearner(torch::Device device, const PaperLearnerOptions& options, Rng& rng);

  double learn(const PaperMinibatch& batch, Rng& rng) override;
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override;
  PaperState state() const override;
  void set_state(const PaperState& state) override;

 private:
  // The edges of the last batch that was asked for here: the next one is mostly of the same graphs.
  struct CachedEdges {
    std::vector<const Graph*> graphs;
    EdgeIndex edges{};
  };
  const EdgeIndex& edges_of(const GraphBatch& batch, CachedEdges& cache) const;
  torch::Tensor to_device(const std::vector<float>& values, std::vector<std::int64_t> shape) const;

  torch::Device device_;
  PaperLearnerOptions options_;
  AdamOptions adam_;
  std::int64_t adam_steps_ = 0;
  torch::Tensor values_;         // [all]
  torch::Tensor target_values_;  // [all]
  torch::Tensor gradients_;      // [trainable], as the moments
  torch::Tensor first_;
  torch::Tensor second_;
  NamedTensors online_;
  NamedTensors target_;
  CachedEdges of_minibatch_;
  CachedEdges of_move_;
};

// Makes a learner on any device: on the CPU that of the kernels, which is faster. Throws Error where LibTorch does not
// have the device.
std::unique_ptr<PaperLearner> make_paper_device_learner(const std::string& device, const PaperLearnerOptions& options,
                                                        Rng& rng);

}  // namespace graphdrl
