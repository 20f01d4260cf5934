#include "graphdrl/train/kernel_learner.h"

#include <torch/torch.h>

#include <algorithm>

#include "graphdrl/nn/features.h"
#include "graphdrl/train/td_target.h"

namespace graphdrl {
namespace {

// A tensor on the memory of a vector, for reading.
template <typename T>
torch::Tensor as_tensor(const std::vector<T>& values, std::vector<std::int64_t> shape) {
  return torch::from_blob(const_cast<T*>(values.data()), shape, torch::CppTypeToScalarType<T>::value);
}

}  // namespace

KernelLearner::KernelLearner(const LearnerOptions& options, Rng& rng)
    : options_(options),
      online_(PaperParameters(rng)),
      target_(online_.parameters()),
      adam_(PaperParameters::trainable_count(), {.learning_rate = options.learning_rate}) {
  at::set_num_threads(1);  // LibTorch's own operators: their sums would depend on the number of threads
}

double KernelLearner::compute_gradients(const Minibatch& batch, const torch::Tensor& keep_scale) {
  const std::int64_t graphs = batch.graphs.graph_count();
  const std::int64_t nodes = batch.graphs.node_count();
  next_q_.resize(static_cast<std::size_t>(graphs * kActionCount));
  target_.q_values(batch.graphs, batch.next_x, next_q_);
  TdBatch td{.reward = as_tensor(batch.rewards, {graphs}),
             .terminal = as_tensor(batch.terminal, {graphs}).to(torch::kBool),
             .next_q = as_tensor(next_q_, {graphs, kActionCount}),
             .chooser = {}};
  td.chooser = td.next_q;
  if (options_.double_dqn) {
    next_online_.resize(next_q_.size());
    online_.q_values(batch.graphs, batch.next_x, next_online_);
    td.chooser = as_tensor(next_online_, {graphs, kActionCount});
  }
  const torch::Tensor target = td_targets(td, options_.discount);

  online_.gradients().zero_();
  const torch::Tensor q = online_.forward_train(batch.graphs, as_tensor(batch.x, {nodes, kFeatureCount}), keep_scale);
  const torch::Tensor chosen = q.gather(1, as_tensor(batch.actions, {graphs, 1})).squeeze(1);
  const torch::Tensor loss = torch::mse_loss(chosen, target);  // L(θ) [paper, eq. 5]
  loss.backward();
  return loss.item<double>();
}

double KernelLearner::learn(const Minibatch& batch, Rng& rng) {
  const double loss =
      compute_gradients(batch, draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, options_.dropout, rng));
  const torch::Tensor& grad = online_.gradients();
  const std::span<float> values = online_.parameters().values();
  adam_.step({grad.data_ptr<float>(), static_cast<std::size_t>(grad.numel())},
             values.first(PaperParameters::trainable_count()));
  soft_update(values, options_.soft_update, target_.parameters().values());
  online_.update();
  target_.update();
  return loss;
}

LearnerState KernelLearner::state() const {
  return {.online = online_.parameters(),
          .target = target_.parameters(),
          .adam_first = adam_.first(),
          .adam_second = adam_.second(),
          .adam_steps = adam_.steps()};
}

void KernelLearner::set_state(const LearnerState& state) {
  const auto copy = [](const PaperParameters& from, PaperParameters& to) {
    std::copy(from.values().begin(), from.values().end(), to.values().begin());
  };
  copy(state.online, online_.parameters());
  copy(state.target, target_.parameters());
  adam_.first() = state.adam_first;
  adam_.second() = state.adam_second;
  adam_.steps() = state.adam_steps;
  online_.update();
  target_.update();
}

}  // namespace graphdrl
