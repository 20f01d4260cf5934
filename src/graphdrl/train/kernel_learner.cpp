#include "graphdrl/train/kernel_learner.h"

#include <algorithm>

#include "graphdrl/train/td_target.h"

namespace graphdrl {

KernelLearner::KernelLearner(const LearnerOptions& options, Rng& rng)
    : options_(options),
      online_(PaperParameters(rng)),
      target_(online_.parameters()),
      adam_(PaperParameters::trainable_count(), {.learning_rate = options.learning_rate}) {}

double KernelLearner::compute_gradients(const Minibatch& batch, std::span<const float> keep_scale) {
  const int graphs = batch.graphs.graph_count();
  next_q_.resize(static_cast<std::size_t>(graphs) * kActionCount);
  target_.q_values(batch.graphs, batch.next_x, next_q_);
  TdBatch td{.rewards = batch.rewards, .terminal = batch.terminal, .next_q = next_q_, .chooser = next_q_};
  if (options_.double_dqn) {
    next_online_.resize(next_q_.size());
    online_.q_values(batch.graphs, batch.next_x, next_online_);
    td.chooser = next_online_;
  }
  const std::vector<float> targets = td_targets(td, options_.discount);

  q_.resize(next_q_.size());
  online_.forward_train(batch.graphs, batch.x, keep_scale, q_);
  double loss = 0;  // L(θ) [paper, eq. 5], a mean of squares
  for (int g = 0; g < graphs; ++g) {
    float* const row = q_.data() + static_cast<std::ptrdiff_t>(g) * kActionCount;
    const std::int64_t action = batch.actions[g];
    const float error = row[action] - targets[g];
    loss += double{error} * error / graphs;
    std::fill_n(row, kActionCount, 0.0f);
    row[action] = 2 * error / static_cast<float>(graphs);
  }
  online_.backward(batch.graphs, keep_scale, q_);
  return loss;
}

double KernelLearner::learn(const Minibatch& batch, Rng& rng) {
  const double loss =
      compute_gradients(batch, draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, options_.dropout, rng));
  const std::size_t trainable = PaperParameters::trainable_count();
  const std::span<float> values = online_.parameters().values();
  adam_.step(online_.gradients().values().first(trainable), values.first(trainable));
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
