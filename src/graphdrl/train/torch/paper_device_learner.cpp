#include "graphdrl/train/torch/paper_device_learner.h"

#include <torch/torch.h>

#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/paper_q_network.h"

namespace graphdrl {
namespace {

torch::Tensor to_tensor(std::span<const float> values) {
  return torch::from_blob(const_cast<float*>(values.data()), {static_cast<std::int64_t>(values.size())}).clone();
}

void copy_out(const torch::Tensor& tensor, std::span<float> values) {
  const torch::Tensor host = tensor.to(torch::kCPU).contiguous();
  std::copy_n(host.data_ptr<float>(), values.size(), values.begin());
}

}  // namespace

PaperDeviceLearner::PaperDeviceLearner(torch::Device device, const PaperLearnerOptions& options, Rng& rng)
    : device_(device), options_(options), adam_{.learning_rate = options.learning_rate} {
  torch::set_num_threads(1);  // so that sums on the CPU run in one order
  PaperState state{.online = PaperParameters(rng), .target = {}, .adam = AdamState(PaperParameters::trainable_count())};
  state.target = state.online;
  set_state(state);
}

const EdgeIndex& PaperDeviceLearner::edges_of(const GraphBatch& batch, CachedEdges& cache) const {
  std::vector<const Graph*> graphs;
  for (int g = 0; g < batch.graph_count(); ++g) graphs.push_back(&batch.graph(g));
  if (graphs != cache.graphs) {
    cache.edges = edge_index(batch, device_);
    cache.graphs = std::move(graphs);
  }
  return cache.edges;
}

torch::Tensor PaperDeviceLearner::to_device(const std::vector<float>& values, std::vector<std::int64_t> shape) const {
  return torch::from_blob(const_cast<float*>(values.data()), shape).to(device_);
}

double PaperDeviceLearner::learn(const PaperMinibatch& batch, Rng& rng) {
  const std::int64_t graphs = batch.graphs.graph_count();
  const std::int64_t nodes = batch.graphs.node_count();
  const EdgeIndex& edges = edges_of(batch.graphs, of_minibatch_);
  const std::vector<float> kept = draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, options_.dropout, rng);
  const torch::Tensor keep_scale = to_device(kept, {graphs, kHiddenWidth});
  torch::Tensor targets;
  {
    const torch::NoGradGuard no_grad;
    const torch::Tensor next_x = to_device(batch.next_x, {nodes, kPaperFeatureCount});
    const torch::Tensor next_q = composed_q_values(edges, next_x, target_);
    const torch::Tensor chooser = options_.double_dqn ? composed_q_values(edges, next_x, online_) : next_q;
    const torch::Tensor value = next_q.gather(1, chooser.argmax(1, /*keepdim=*/true)).squeeze(1);
    const torch::Tensor terminal =
        torch::tensor(std::vector<std::int64_t>(batch.terminal.begin(), batch.terminal.end()))
            .to(device_, torch::kBool);
    // As td_targets(), without a copy to the host.
    targets = to_device(batch.rewards, {graphs}) + options_.discount * value.masked_fill(terminal, 0.0);
  }
  gradients_.zero_();
  const torch::Tensor q =
      composed_q_values(edges, to_device(batch.x, {nodes, kPaperFeatureCount}), online_, keep_scale);
  const torch::Tensor chosen = q.gather(1, torch::tensor(batch.actions).to(device_).unsqueeze(1)).squeeze(1);
  const torch::Tensor loss = torch::mse_loss(chosen, targets);  // L(θ) [paper, eq. 5]
  loss.backward();

  const torch::NoGradGuard no_grad;
  ++adam_steps_;
  const auto t = static_cast<double>(adam_steps_);
  gradients_.clamp_(-adam_.clamp, adam_.clamp);
  first_.mul_(adam_.beta1).add_(gradients_, 1 - adam_.beta1);
  second_.mul_(adam_.beta2).addcmul_(gradients_, gradients_, 1 - adam_.beta2);
  const torch::Tensor scale = second_.sqrt().div_(std::sqrt(1 - std::pow(adam_.beta2, t))).add_(adam_.epsilon);
  values_.narrow(0, 0, first_.numel()).addcdiv_(first_, scale, -adam_.learning_rate / (1 - std::pow(adam_.beta1, t)));
  target_values_.lerp_(values_, options_.soft_update);  // [paper, eq. 6]
  return loss.item<double>();
}

void PaperDeviceLearner::q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) {
  const torch::NoGradGuard no_grad;
  const torch::Tensor input = to_tensor(x).view({batch.node_count(), kPaperFeatureCount}).to(device_);
  copy_out(composed_q_values(edges_of(batch, of_move_), input, online_), q);
}

PaperState PaperDeviceLearner::state() const {
  PaperState state{.online = {}, .target = {}, .adam = AdamState(PaperParameters::trainable_count())};
  copy_out(values_, state.online.values());
  copy_out(target_values_, state.target.values());
  copy_out(first_, state.adam.exp_avg);
  copy_out(second_, state.adam.exp_avg_sq);
  state.adam.steps = adam_steps_;
  return state;
}

void PaperDeviceLearner::set_state(const PaperState& state) {
  values_ = to_tensor(state.online.values()).to(device_);
  target_values_ = to_tensor(state.target.values()).to(device_);
  first_ = to_tensor(state.adam.exp_avg).to(device_);
  second_ = to_tensor(state.adam.exp_avg_sq).to(device_);
  gradients_ = torch::zeros_like(first_);
  online_ = named_tensors(values_, gradients_);
  target_ = named_tensors(target_values_);
  adam_steps_ = state.adam.steps;
}

std::unique_ptr<PaperLearner> make_paper_device_learner(const std::string& device, const PaperLearnerOptions& options,
                                                        Rng& rng) {
  if (device == "cpu") return make_paper_cpu_learner(device, options, rng);
  if (!torch::cuda::is_available()) {
    throw Error({.what = "this LibTorch finds no CUDA device", .expected = "cpu", .got = device, .where = "--device"});
  }
  return std::make_unique<PaperDeviceLearner>(torch::Device(device), options, rng);
}

}  // namespace graphdrl
