#include "graphdrl/train/paper_q_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "graphdrl/nn/vector_math.h"

namespace graphdrl {
namespace {

void multiply(std::span<const float> scale, std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= scale[i];
}

}  // namespace

PaperQNetwork::PaperQNetwork(PaperParameters parameters) : parameters_(std::move(parameters)) {
  update();
}

BatchNormTensors PaperQNetwork::batch_norm_weights(int layer) const {
  return {.weight = parameters_.tensor(fmt::format("bn{}.weight", layer)),
          .bias = parameters_.tensor(fmt::format("bn{}.bias", layer))};
}

void PaperQNetwork::forward_train(const GraphBatch& batch, std::span<const float> x, std::span<const float> keep_scale,
                                  std::span<float> q) {
  const int nodes = batch.node_count();
  const int graphs = batch.graph_count();
  const float* input = x.data();
  for (int layer = 1; layer <= 3; ++layer) {
    const int width = kConvShapes[layer - 1].width;
    std::vector<float>& output = outputs_[layer - 1];
    output.resize(static_cast<std::size_t>(nodes) * width);
    inference_.conv(layer).forward(batch, input, output.data(), /*keep=*/true);
    if (layer == 3) break;
    ColumnStatistics& statistics = statistics_[layer - 1];
    statistics = column_statistics(nodes, width, output.data(), kBatchNormEpsilon);
    float* const running_mean = parameters_.tensor(fmt::format("bn{}.running_mean", layer));
    float* const running_variance = parameters_.tensor(fmt::format("bn{}.running_var", layer));
    const float unbiased = static_cast<float>(nodes) / static_cast<float>(std::max(nodes - 1, 1));
    constexpr auto kMomentum = static_cast<float>(kBatchNormMomentum);
    for (int i = 0; i < width; ++i) {
      running_mean[i] += kMomentum * (statistics.mean[i] - running_mean[i]);
      running_variance[i] += kMomentum * (statistics.variance[i] * unbiased - running_variance[i]);
    }
    std::vector<float>& normalised = normalised_[layer - 1];
    normalised.resize(output.size());
    batch_norm(nodes, width, output.data(), statistics, batch_norm_weights(layer), normalised.data());
    input = normalised.data();
  }
  pooled_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.inputs);
  activated_.resize(static_cast<std::size_t>(graphs) * kFc1Shape.outputs);
  sum_pool(batch, kFc1Shape.inputs, outputs_[2].data(), pooled_.data());
  linear(kFc1Shape, graphs, pooled_.data(), std::as_const(parameters_).linear("fc1"), activated_.data());
  elu(activated_.data(), activated_.size());
  hidden_ = activated_;
  multiply(keep_scale, hidden_);
  linear(kFc2Shape, graphs, hidden_.data(), std::as_const(parameters_).linear("fc2"), q.data());
}

void PaperQNetwork::backward(const GraphBatch& batch, std::span<const float> keep_scale,
                             std::span<const float> grad_q) {
  const int nodes = batch.node_count();
  const int graphs = batch.graph_count();
  grad_hidden_.resize(hidden_.size());
  grad_pooled_.resize(pooled_.size());
  for (int layer = 0; layer < 3; ++layer) grads_[layer].resize(outputs_[layer].size());
  linear_backward(kFc2Shape, graphs, hidden_.data(), std::as_const(parameters_).linear("fc2"), grad_q.data(),
                  grad_hidden_.data(), gradients_.linear("fc2"));
  multiply(keep_scale, grad_hidden_);
  elu_backward(activated_.data(), grad_hidden_.data(), grad_hidden_.size());
  linear_backward(kFc1Shape, graphs, pooled_.data(), std::as_const(parameters_).linear("fc1"), grad_hidden_.data(),
                  grad_pooled_.data(), gradients_.linear("fc1"));
  sum_pool_backward(batch, kFc1Shape.inputs, grad_pooled_.data(), grads_[2].data());
  for (int layer = 3; layer >= 1; --layer) {
    float* const by_input = layer > 1 ? grads_[layer - 2].data() : nullptr;
    inference_.conv(layer).backward(batch, outputs_[layer - 1].data(), grads_[layer - 1].data(), by_input,
                                    gradients_.conv(layer));
    if (layer == 1) break;
    const int normal = layer - 1;
    batch_norm_backward(nodes, kConvShapes[normal - 1].width, outputs_[normal - 1].data(), statistics_[normal - 1],
                        batch_norm_weights(normal), by_input, gradients_.tensor(fmt::format("bn{}.weight", normal)),
                        gradients_.tensor(fmt::format("bn{}.bias", normal)));
  }
}

std::vector<float> draw_keep_scale(int rows, int width, double p, Rng& rng) {
  std::vector<float> scale(static_cast<std::size_t>(rows) * width);
  for (float& value : scale) value = rng.uniform() < p ? 0.0f : static_cast<float>(1 / (1 - p));
  return scale;
}

}  // namespace graphdrl
