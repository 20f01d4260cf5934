#include "graphdrl/train/learner.h"

#include <torch/torch.h>

#include <algorithm>

#include "graphdrl/base/error.h"
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

Learner::Learner(const LearnerOptions& options, Rng& rng)
    : options_(options),
      online_(PaperParameters(rng)),
      target_(online_.parameters()),
      adam_(PaperParameters::trainable_count(), {.learning_rate = options.learning_rate}) {
  at::set_num_threads(1);  // LibTorch's own operators: their sums would depend on the number of threads
}

double Learner::compute_gradients(const Minibatch& batch, const torch::Tensor& keep_scale) {
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

double Learner::learn(const Minibatch& batch, Rng& rng) {
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

void Learner::save(Packed& packed, std::vector<TensorView>& tensors) {
  for (const TensorView& view : online_.parameters().views("online.")) tensors.push_back(view);
  for (const TensorView& view : target_.parameters().views("target.")) tensors.push_back(view);
  const auto count = static_cast<std::int64_t>(PaperParameters::trainable_count());
  tensors.emplace_back("adam.exp_avg", Shape{count}, std::span<const float>(adam_.first()));
  tensors.emplace_back("adam.exp_avg_sq", Shape{count}, std::span<const float>(adam_.second()));
  packed.adam_step = {adam_.steps()};
  tensors.emplace_back("adam.step", Shape{1}, std::span<const std::int64_t>(packed.adam_step));
}

void Learner::restore(const Safetensors& file) {
  const PaperParameters online = PaperParameters::from_file(file, "online.");
  const PaperParameters target = PaperParameters::from_file(file, "target.");
  const auto count = static_cast<std::int64_t>(PaperParameters::trainable_count());
  const auto first = file.get<float>("adam.exp_avg", {count});
  const auto second = file.get<float>("adam.exp_avg_sq", {count});
  const std::int64_t step = file.get<std::int64_t>("adam.step", {1}).front();
  const bool moments_are_real = std::all_of(second.begin(), second.end(), [](float value) { return value >= 0; });
  if (step < 0 || !moments_are_real) throw Error({.what = "Adam's state is damaged", .where = file.source()});
  std::copy(online.values().begin(), online.values().end(), online_.parameters().values().begin());
  std::copy(target.values().begin(), target.values().end(), target_.parameters().values().begin());
  adam_.first() = first;
  adam_.second() = second;
  adam_.steps() = step;
  online_.update();
  target_.update();
}

}  // namespace graphdrl
