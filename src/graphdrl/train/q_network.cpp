#include "graphdrl/train/q_network.h"

#include <fmt/format.h>
#include <torch/torch.h>

namespace graphdrl {

QNetwork::QNetwork(PaperParameters parameters) : parameters_(std::move(parameters)) {
  const std::span<float> memory = parameters_.values();
  values_ = torch::from_blob(memory.data(), {static_cast<std::int64_t>(memory.size())});
  gradients_ = torch::zeros({static_cast<std::int64_t>(PaperParameters::trainable_count())});
  leaves_ = named_tensors(values_, gradients_);
  update();
}

GatedGraphConvLeaves QNetwork::conv_leaves(int layer) const {
  const std::string name = fmt::format("conv{}", layer);
  return {.weight = leaves_.at(name + ".weight"),
          .w_ih = leaves_.at(name + ".rnn.weight_ih"),
          .w_hh = leaves_.at(name + ".rnn.weight_hh"),
          .b_ih = leaves_.at(name + ".rnn.bias_ih"),
          .b_hh = leaves_.at(name + ".rnn.bias_hh")};
}

torch::Tensor QNetwork::forward_train(const GraphBatch& batch, const torch::Tensor& x,
                                      const torch::Tensor& keep_scale) {
  torch::Tensor h = x;
  for (int layer = 1; layer <= 3; ++layer) {
    h = gated_graph_conv(inference_.conv(layer), batch, h, conv_leaves(layer));
    if (layer == 3) break;
    const std::string name = fmt::format("bn{}", layer);
    h = torch::batch_norm(h, leaves_.at(name + ".weight"), leaves_.at(name + ".bias"),
                          leaves_.at(name + ".running_mean"), leaves_.at(name + ".running_var"), /*training=*/true,
                          kBatchNormMomentum, kBatchNormEpsilon, /*cudnn_enabled=*/false);
  }
  // Sum pooling as a product: cheaper than LibTorch's sums over ragged ranges.
  const torch::Tensor pooling = torch::zeros({batch.graph_count(), batch.node_count()});
  for (int g = 0; g < batch.graph_count(); ++g) {
    float* const row = pooling.data_ptr<float>() + static_cast<std::ptrdiff_t>(g) * batch.node_count();
    std::fill(row + batch.first_node(g), row + batch.first_node(g + 1), 1.0f);
  }
  h = torch::mm(pooling, h);
  h = torch::elu(torch::linear(h, leaves_.at("fc1.weight"), leaves_.at("fc1.bias"))) * keep_scale;
  return torch::linear(h, leaves_.at("fc2.weight"), leaves_.at("fc2.bias"));
}

torch::Tensor draw_keep_scale(std::int64_t rows, std::int64_t width, double p, Rng& rng) {
  torch::Tensor scale = torch::empty({rows, width});
  const std::span<float> values(scale.data_ptr<float>(), static_cast<std::size_t>(rows * width));
  for (float& value : values) value = rng.uniform() < p ? 0.0f : static_cast<float>(1 / (1 - p));
  return scale;
}

}  // namespace graphdrl
