#include "graphdrl/train/learner.h"

#include <torch/torch.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/nn/features.h"
#include "graphdrl/train/td_target.h"

namespace graphdrl {
namespace {

constexpr double kGradientClamp = 1.0;  // element by element, as in the author's code

// A tensor on the memory of a vector, for reading.
template <typename T>
torch::Tensor as_tensor(const std::vector<T>& values, std::vector<std::int64_t> shape) {
  return torch::from_blob(const_cast<T*>(values.data()), shape, torch::CppTypeToScalarType<T>::value);
}

}  // namespace

Learner::Learner(const LearnerOptions& options, Rng& rng)
    : options_(options), online_(PaperParameters(rng)), target_(online_.parameters()) {
  at::set_num_threads(1);  // LibTorch's own operators: their sums would depend on the number of threads
  adam_ = std::make_unique<torch::optim::Adam>(std::vector<torch::Tensor>{online_.trainable()},
                                               torch::optim::AdamOptions(options.learning_rate));
  adam_->step();  // the gradient is 0, so that this changes nothing but makes Adam's state, which restore() fills
  adam_state().step(0);
}

Learner::~Learner() = default;

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

  online_.trainable().mutable_grad().zero_();
  const torch::Tensor q = online_.forward_train(batch.graphs, as_tensor(batch.x, {nodes, kFeatureCount}), keep_scale);
  const torch::Tensor chosen = q.gather(1, as_tensor(batch.actions, {graphs, 1})).squeeze(1);
  const torch::Tensor loss = torch::mse_loss(chosen, target);  // L(θ) [paper, eq. 5]
  loss.backward();
  return loss.item<double>();
}

double Learner::learn(const Minibatch& batch, Rng& rng) {
  const double loss =
      compute_gradients(batch, draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, options_.dropout, rng));
  online_.trainable().mutable_grad().clamp_(-kGradientClamp, kGradientClamp);
  adam_->step();
  const torch::NoGradGuard no_grad;
  target_.values().lerp_(online_.values(), options_.soft_update);  // θ' ← β θ + (1 - β) θ' [paper, eq. 6]
  online_.update();
  target_.update();
  return loss;
}

torch::optim::AdamParamState& Learner::adam_state() {
  return static_cast<torch::optim::AdamParamState&>(*adam_->state().begin()->second);
}

void Learner::save(Packed& packed, std::vector<TensorView>& tensors) {
  for (const TensorView& view : online_.parameters().views("online.")) tensors.push_back(view);
  for (const TensorView& view : target_.parameters().views("target.")) tensors.push_back(view);
  const auto add = [&](const char* name, const torch::Tensor& values) {
    tensors.emplace_back(name, Shape{values.numel()},
                         std::span<const float>(values.data_ptr<float>(), static_cast<std::size_t>(values.numel())));
  };
  add("adam.exp_avg", adam_state().exp_avg());
  add("adam.exp_avg_sq", adam_state().exp_avg_sq());
  packed.adam_step = {adam_state().step()};
  tensors.emplace_back("adam.step", Shape{1}, std::span<const std::int64_t>(packed.adam_step));
}

void Learner::restore(const Safetensors& file) {
  const torch::NoGradGuard no_grad;
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
  std::copy(first.begin(), first.end(), adam_state().exp_avg().data_ptr<float>());
  std::copy(second.begin(), second.end(), adam_state().exp_avg_sq().data_ptr<float>());
  adam_state().step(step);
  online_.update();
  target_.update();
}

}  // namespace graphdrl
