#include "graphdrl/train/torch/paper_composed_network.h"

#include <fmt/format.h>
#include <torch/torch.h>

#include <vector>

namespace graphdrl {

NamedTensors named_tensors(const torch::Tensor& values, const torch::Tensor& gradients) {
  NamedTensors tensors;
  for (const TensorSpec& spec : PaperParameters::specs()) {
    const auto view = [&](const torch::Tensor& flat) {
      return flat.narrow(0, static_cast<std::int64_t>(spec.offset), static_cast<std::int64_t>(spec.size))
          .view(spec.shape);
    };
    torch::Tensor tensor = view(values);
    if (spec.trainable && gradients.defined()) {
      tensor.set_requires_grad(true);
      tensor.mutable_grad() = view(gradients);
    }
    tensors[spec.name] = tensor;
  }
  return tensors;
}

EdgeIndex edge_index(const GraphBatch& batch, torch::Device device) {
  std::vector<std::int64_t> from;
  std::vector<std::int64_t> to;
  std::vector<std::int64_t> graph_of;
  for (int g = 0; g < batch.graph_count(); ++g) {
    for (NodeId node = 0; node < batch.graph(g).node_count(); ++node) {
      graph_of.push_back(g);
      for (const NodeId next : batch.graph(g).neighbours(node)) {
        from.push_back(batch.first_node(g) + next);
        to.push_back(batch.first_node(g) + node);
      }
    }
  }
  const auto on_device = [&](const std::vector<std::int64_t>& values) {
    return torch::tensor(values, torch::kInt64).to(device);
  };
  return {on_device(from), on_device(to), on_device(graph_of), batch.graph_count()};
}

torch::Tensor composed_conv(const EdgeIndex& edges, const torch::Tensor& x, const NamedTensors& tensors,
                            const std::string& name) {
  const torch::Tensor& weight = tensors.at(name + ".weight");
  torch::Tensor h = torch::constant_pad_nd(x, {0, weight.size(1) - x.size(1)});
  for (std::int64_t step = 0; step < weight.size(0); ++step) {
    const torch::Tensor sent = torch::matmul(h, weight[step]);
    const torch::Tensor message = torch::zeros_like(sent).index_add(0, edges.to, sent.index_select(0, edges.from));
    h = torch::gru_cell(message, h, tensors.at(name + ".rnn.weight_ih"), tensors.at(name + ".rnn.weight_hh"),
                        tensors.at(name + ".rnn.bias_ih"), tensors.at(name + ".rnn.bias_hh"));
  }
  return h;
}

torch::Tensor composed_q_values(const EdgeIndex& edges, const torch::Tensor& x, const NamedTensors& tensors,
                                const torch::Tensor& keep_scale) {
  const bool train = keep_scale.defined();
  torch::Tensor h = x;
  for (int layer = 1; layer <= 3; ++layer) {
    h = torch::elu(composed_conv(edges, h, tensors, fmt::format("conv{}", layer)));
    if (layer == 3) break;
    const std::string name = fmt::format("bn{}", layer);
    h = torch::batch_norm(h, tensors.at(name + ".weight"), tensors.at(name + ".bias"),
                          tensors.at(name + ".running_mean"), tensors.at(name + ".running_var"), train,
                          kBatchNormMomentum, kBatchNormEpsilon, /*cudnn_enabled=*/false);
  }
  h = torch::zeros({edges.graph_count, h.size(1)}, h.options()).index_add(0, edges.graph_of, h);  // sum pooling
  h = torch::elu(torch::linear(h, tensors.at("fc1.weight"), tensors.at("fc1.bias")));
  if (train) h = h * keep_scale;
  return torch::linear(h, tensors.at("fc2.weight"), tensors.at("fc2.bias"));
}

}  // namespace graphdrl
