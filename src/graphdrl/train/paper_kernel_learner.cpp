#include "graphdrl/train/paper_kernel_learner.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {

std::vector<float> draw_keep_scale(int rows, int width, double p, Rng& rng) {
  std::vector<float> scale(static_cast<std::size_t>(rows) * width);
  for (float& value : scale) value = rng.uniform() < p ? 0.0f : static_cast<float>(1 / (1 - p));
  return scale;
}

std::vector<float> td_targets(const PaperMinibatch& batch, std::span<const float> next_q,
                              std::span<const float> chooser, double discount) {
  std::vector<float> targets = batch.rewards;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (batch.terminal[i] != 0) continue;
    const std::span<const float> row = chooser.subspan(i * kActionCount, kActionCount);
    const std::ptrdiff_t best = std::max_element(row.begin(), row.end()) - row.begin();
    targets[i] += static_cast<float>(discount) * next_q[i * kActionCount + best];  // y [paper, eq. 5]
  }
  return targets;
}

void PaperKernelLearner::update() {
  network_.set_parameters(state_.online);
  target_network_.set_parameters(state_.target);
}

double PaperKernelLearner::compute_gradients(const PaperMinibatch& batch, std::span<const float> keep_scale) {
  const int graphs = batch.graphs.graph_count();
  next_q_.resize(static_cast<std::size_t>(graphs) * kActionCount);
  target_network_.q_values(batch.graphs, batch.next_x, next_q_);
  if (options_.double_dqn) {
    next_online_.resize(next_q_.size());
    network_.q_values(batch.graphs, batch.next_x, next_online_);
  }
  const std::vector<float> targets =
      td_targets(batch, next_q_, options_.double_dqn ? next_online_ : next_q_, options_.discount);

  q_.resize(next_q_.size());
  network_.q_values(batch.graphs, batch.x, q_, keep_scale);
  network_.move_statistics(batch.graphs.node_count(), state_.online);
  double loss = 0;  // L(θ) [paper, eq. 5], a mean of squares
  for (int g = 0; g < graphs; ++g) {
    float* const row = q_.data() + static_cast<std::ptrdiff_t>(g) * kActionCount;
    const std::int64_t action = batch.actions[g];
    const float error = row[action] - targets[g];
    loss += double{error} * error / graphs;
    std::fill_n(row, kActionCount, 0.0f);
    row[action] = 2 * error / static_cast<float>(graphs);
  }
  network_.backward(batch.graphs, keep_scale, q_, grad_);
  return loss;
}

void PaperKernelLearner::learn(const PaperMinibatch& batch, Rng& rng) {
  losses_.push_back(
      compute_gradients(batch, draw_keep_scale(batch.graphs.graph_count(), kHiddenWidth, options_.dropout, rng)));
  const std::size_t trainable = PaperParameters::trainable_count();
  state_.adam.step(grad_.values().first(trainable), options_.learning_rate, state_.online.values().first(trainable));
  soft_update(state_.online.values(), options_.soft_update, state_.target.values());
  update();
}

std::unique_ptr<PaperLearner> LearnerSource::make(const std::string& device, const PaperLearnerOptions& options,
                                                  Rng& rng) const {
  if (device == "cpu") return std::make_unique<PaperKernelLearner>(options, rng);
  throw Error({.what = "this program trains on the CPU alone", .expected = "cpu", .got = device, .where = "--device"});
}

std::vector<std::unique_ptr<LearnerSource>> LearnerSource::make_together(const std::string& /*device*/,
                                                                         int /*trainings*/) const {
  return {};
}

}  // namespace graphdrl
