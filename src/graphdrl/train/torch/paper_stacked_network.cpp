#include "graphdrl/train/torch/paper_stacked_network.h"

#include <torch/torch.h>

#include <algorithm>
#include <tuple>
#include <vector>

namespace graphdrl {
namespace {

// x [S, R, I] times the transposed weights NAME [S, O, I], and the bias [S, O].
torch::Tensor stacked_linear(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias) {
  return torch::baddbmm(bias.unsqueeze(1), x, weight.transpose(1, 2));
}

// One GRU cell [Cho et al. 2014], as PyTorch's: x and h [S, R, D]. CUDA has a kernel for what follows the products.
torch::Tensor stacked_gru(const torch::Tensor& x, const torch::Tensor& h, const NamedTensors& tensors,
                          const std::string& name) {
  const auto of = [&](const char* tensor) { return tensors.at(name + tensor); };
  const torch::Tensor inputs = stacked_linear(x, of(".weight_ih"), of(".bias_ih"));
  const torch::Tensor states = stacked_linear(h, of(".weight_hh"), of(".bias_hh"));
  if (h.is_cuda()) {
    const auto rows = [](const torch::Tensor& all) { return all.reshape({-1, all.size(2)}); };
    return std::get<0>(at::_thnn_fused_gru_cell(rows(inputs), rows(states), rows(h))).view(h.sizes());
  }
  const std::vector<torch::Tensor> input = inputs.chunk(3, 2);
  const std::vector<torch::Tensor> state = states.chunk(3, 2);
  const torch::Tensor reset = torch::sigmoid(input[0] + state[0]);
  const torch::Tensor update = torch::sigmoid(input[1] + state[1]);
  const torch::Tensor fresh = torch::tanh(input[2] + reset * state[2]);
  return fresh + update * (h - fresh);  // (1 - z) n + z h
}

// A gated graph convolution without its ELU [paper, eq. 7]. x: [S, B * n, F], F <= D; gives [S, B * n, D].
torch::Tensor stacked_conv(const StackedGraphs& graphs, const torch::Tensor& x, const NamedTensors& tensors,
                           const std::string& name) {
  const torch::Tensor& weight = tensors.at(name + ".weight");  // [S, L, D, D]
  const std::int64_t nodes = graphs.adjacent.size(1);
  torch::Tensor h = torch::constant_pad_nd(x, {0, weight.size(2) - x.size(2)});
  for (std::int64_t step = 0; step < weight.size(1); ++step) {
    const torch::Tensor sent = torch::bmm(h, weight.select(1, step));
    const torch::Tensor message = torch::bmm(graphs.adjacent, sent.reshape({-1, nodes, sent.size(2)}));
    h = stacked_gru(message.reshape(sent.sizes()), h, tensors, name + ".rnn");
  }
  return h;
}

// Batch normalisation over the nodes of each training. x: [S, R, D]; node_mask: [S, R, 1].
torch::Tensor stacked_batch_norm(const torch::Tensor& x, const torch::Tensor& node_mask, const NamedTensors& tensors,
                                 const std::string& name, const torch::Tensor& active) {
  const auto of = [&](const char* tensor) { return tensors.at(name + tensor).unsqueeze(1); };  // [S, 1, D]
  torch::Tensor mean = of(".running_mean");
  torch::Tensor variance = of(".running_var");
  if (active.defined()) {
    const torch::Tensor rows = node_mask.sum(1, /*keepdim=*/true).clamp_min(2);  // [S, 1, 1]; 2 where nothing is active
    mean = (x * node_mask).sum(1, /*keepdim=*/true) / rows;
    variance = ((x - mean).square() * node_mask).sum(1, /*keepdim=*/true) / rows;
    const torch::NoGradGuard no_grad;
    const torch::Tensor momentum = kBatchNormMomentum * active.view({-1, 1, 1});
    of(".running_mean").lerp_(mean, momentum.expand_as(mean));
    of(".running_var").lerp_(variance * (rows / (rows - 1)), momentum.expand_as(mean));
  }
  return (x - mean) * torch::rsqrt(variance + kBatchNormEpsilon) * of(".weight") + of(".bias");
}

}  // namespace

KnownGraphs::KnownGraphs(c10::Device device)
    : adjacent_(torch::zeros({1, 1, 1}, device)), node_mask_(torch::zeros({1, 1, 1}, device)) {}

std::int64_t KnownGraphs::add(const Graph& graph) {
  const std::int64_t nodes = graph.node_count();
  const std::int64_t capacity = adjacent_.size(0);
  // Doubles, so that the tensors, and what was captured on them, are seldom replaced.
  const std::int64_t more_graphs = size_ == capacity ? capacity : 0;
  const std::int64_t more_nodes = std::max<std::int64_t>(nodes - padded_nodes(), 0);
  if (more_graphs > 0 || more_nodes > 0) {
    adjacent_ = torch::constant_pad_nd(adjacent_, {0, more_nodes, 0, more_nodes, 0, more_graphs});
    node_mask_ = torch::constant_pad_nd(node_mask_, {0, 0, 0, more_nodes, 0, more_graphs});
  }
  torch::Tensor adjacent = torch::zeros({padded_nodes(), padded_nodes()});
  auto edges = adjacent.accessor<float, 2>();
  for (NodeId node = 0; node < graph.node_count(); ++node) {
    for (const NodeId next : graph.neighbours(node)) edges[node][next] += 1;
  }
  adjacent_[size_].copy_(adjacent);
  node_mask_[size_].narrow(0, 0, nodes).fill_(1);
  return size_++;
}

NamedTensors stacked_tensors(const torch::Tensor& values, bool learning) {
  NamedTensors tensors;
  for (const TensorSpec& spec : PaperParameters::specs()) {
    std::vector<std::int64_t> shape = {values.size(0)};
    shape.insert(shape.end(), spec.shape.begin(), spec.shape.end());
    const torch::Tensor flat =
        values.narrow(1, static_cast<std::int64_t>(spec.offset), static_cast<std::int64_t>(spec.size));
    // A version of its own: the running statistics change between a forward and a backward pass.
    torch::Tensor tensor = flat.view(shape).variable_data();
    tensors[spec.name] = tensor.set_requires_grad(spec.trainable && learning);
  }
  return tensors;
}

torch::Tensor stacked_gradient(const torch::Tensor& loss, const NamedTensors& tensors) {
  std::vector<torch::Tensor> leaves;
  for (const TensorSpec& spec : PaperParameters::specs()) {
    if (spec.trainable) leaves.push_back(tensors.at(spec.name));
  }
  std::vector<torch::Tensor> gradients = torch::autograd::grad({loss}, leaves);
  for (torch::Tensor& gradient : gradients) gradient = gradient.reshape({gradient.size(0), -1});
  return torch::cat(gradients, 1);
}

torch::Tensor stacked_q_values(const StackedGraphs& graphs, const torch::Tensor& x, const NamedTensors& tensors,
                               const torch::Tensor& keep_scale, const torch::Tensor& active) {
  const std::int64_t trainings = x.size(0);
  const std::int64_t batch = x.size(1);
  const torch::Tensor node_mask = graphs.node_mask.reshape({trainings, -1, 1});
  torch::Tensor h = x.reshape({trainings, -1, x.size(3)});
  for (int layer = 1; layer <= 3; ++layer) {
    h = torch::elu(stacked_conv(graphs, h, tensors, "conv" + std::to_string(layer)));
    if (layer < 3) h = stacked_batch_norm(h, node_mask, tensors, "bn" + std::to_string(layer), active);
  }
  h = (h * node_mask).view({trainings, batch, -1, h.size(2)}).sum(2);  // sum pooling
  h = torch::elu(stacked_linear(h, tensors.at("fc1.weight"), tensors.at("fc1.bias")));
  if (keep_scale.defined()) h = h * keep_scale;
  return stacked_linear(h, tensors.at("fc2.weight"), tensors.at("fc2.bias"));
}

}  // namespace graphdrl
