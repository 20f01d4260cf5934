// The paper's Q-network as LibTorch trains it.
#pragma once

#include <torch/types.h>

#include "graphdrl/base/random.h"
#include "graphdrl/nn/paper_network.h"
#include "graphdrl/train/composed_network.h"
#include "graphdrl/train/gated_graph_conv_function.h"

namespace graphdrl {

// Parameters in one flat buffer, seen from three sides: by autograd as leaf tensors, whose gradients add up in one flat
// buffer too; by the optimiser as spans; by inference as a PaperNetwork. update() must follow every change of them.
class QNetwork {
 public:
  explicit QNetwork(PaperParameters parameters);
  QNetwork(const QNetwork&) = delete;

  // Train mode [paper, Table 1]: batch norm by the batch's statistics, which also move the running ones; dropout by
  // `keep_scale` [B, 256], 0 where a hidden value is dropped and 1 / (1 - p) where it is kept.
  // x: [N, F]; gives q [B, A]. The batch must stay until backward() is done.
  torch::Tensor forward_train(const GraphBatch& batch, const torch::Tensor& x, const torch::Tensor& keep_scale);

  // Eval mode, without LibTorch. x: [N, F], q: [B, A].
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) {
    inference_.q_values(batch, x, q);
  }

  void update() { inference_.set_parameters(parameters_); }

  PaperParameters& parameters() { return parameters_; }
  const PaperParameters& parameters() const { return parameters_; }
  torch::Tensor& values() { return values_; }        // [all], parameters and running statistics
  torch::Tensor& gradients() { return gradients_; }  // [240678], of the trainable ones, in the buffer's order

 private:
  GatedGraphConvLeaves conv_leaves(int layer) const;

  PaperParameters parameters_;
  PaperNetwork inference_;
  torch::Tensor values_;
  torch::Tensor gradients_;
  NamedTensors leaves_;
};

// 0 with probability p, else 1 / (1 - p); [rows, width] float32.
torch::Tensor draw_keep_scale(std::int64_t rows, std::int64_t width, double p, Rng& rng);

}  // namespace graphdrl
