// The paper's Q-network as the CPU trains it: forward and backward on the kernels of nn/.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/nn/layers.h"
#include "graphdrl/nn/paper_network.h"

namespace graphdrl {

// Parameters in one flat buffer, their gradients in another, and what a forward pass keeps for the backward pass.
// update() must follow every change of the parameters.
class PaperQNetwork {
 public:
  explicit PaperQNetwork(PaperParameters parameters);
  PaperQNetwork(const PaperQNetwork&) = delete;
  PaperQNetwork& operator=(const PaperQNetwork&) = delete;

  // Train mode [paper, Table 1]: batch norm by the batch's statistics, which also move the running ones; dropout by
  // `keep_scale` [B, 256], 0 where a hidden value is dropped and 1 / (1 - p) where it is kept.
  // x: [N, F], q: [B, A].
  void forward_train(const GraphBatch& batch, std::span<const float> x, std::span<const float> keep_scale,
                     std::span<float> q);

  // After forward_train() with the same batch and keep_scale. grad_q: [B, A], the loss's derivative by q; that by the
  // parameters is left in gradients().
  void backward(const GraphBatch& batch, std::span<const float> keep_scale, std::span<const float> grad_q);

  // Eval mode. x: [N, F], q: [B, A].
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) {
    inference_.q_values(batch, x, q);
  }

  void update() { inference_.set_parameters(parameters_); }

  PaperParameters& parameters() { return parameters_; }
  const PaperParameters& parameters() const { return parameters_; }
  const PaperParameters& gradients() const { return gradients_; }  // running statistics have none: 0

 private:
  // One of the two batch norms, by its layer's number.
  BatchNormTensors batch_norm_weights(int layer) const;

  PaperParameters parameters_;
  PaperParameters gradients_;
  PaperNetwork inference_;
  std::array<std::vector<float>, 3> outputs_;     // of the convolutions: [N, D]
  std::array<std::vector<float>, 2> normalised_;  // of the batch norms: [N, D]
  std::array<ColumnStatistics, 2> statistics_;
  std::array<std::vector<float>, 3> grads_;  // by outputs_: [N, D]
  std::vector<float> pooled_;                // [B, 128]
  std::vector<float> activated_;             // [B, 256], before the dropout
  std::vector<float> hidden_;                // [B, 256], after it
  std::vector<float> grad_hidden_;           // [B, 256]
  std::vector<float> grad_pooled_;           // [B, 128]
};

// 0 with probability p, else 1 / (1 - p); [rows, width].
std::vector<float> draw_keep_scale(int rows, int width, double p, Rng& rng);

}  // namespace graphdrl
