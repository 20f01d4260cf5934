// The learner on the kernels of nn/, on the CPU.
#pragma once

#include <utility>
#include <vector>

#include "graphdrl/train/adam.h"
#include "graphdrl/train/paper_learner.h"

namespace graphdrl {

// One-step targets for DQN and Double DQN [paper, eq. 5; van Hasselt et al. 2016]: [B],
//   y = r + discount · (1 - terminal) · Q_target(s', a*)
// where a* maximises Q_target(s', ·) (DQN) or Q_online(s', ·) (Double DQN), over all actions: blocked moves can be
// chosen, so they are not masked. A budget that runs out is no terminal state.
// next_q: [B, A], from the target network; chooser: [B, A], what a* maximises: next_q itself, or the online network's.
std::vector<float> td_targets(const PaperMinibatch& batch, std::span<const float> next_q,
                              std::span<const float> chooser, double discount);

// The online and the target network and the optimiser. Everything it does is the same for any number of threads.
class PaperKernelLearner final : public PaperLearner {
 public:
  PaperKernelLearner(const PaperLearnerOptions& options, Rng& rng) : options_(options), state_(PaperState::begin(rng)) {
    update();
  }
  PaperKernelLearner(const PaperKernelLearner&) = delete;  // the networks point into the parameters

  void learn(const PaperMinibatch& batch, Rng& rng) override;
  std::vector<double> take_losses() override { return std::exchange(losses_, {}); }
  void q_values(const GraphBatch& batch, std::span<const float> x, std::span<float> q) override {
    network_.q_values(batch, x, q);
  }
  PaperState state() const override { return state_; }
  void set_state(const PaperState& state) override {
    state_ = state;
    update();
  }

  // The loss [paper, eq. 5]; its gradients stay in gradients(), not clamped yet. Moves the running statistics.
  // keep_scale: [B, 256], see PaperNetwork::q_values.
  double compute_gradients(const PaperMinibatch& batch, std::span<const float> keep_scale);

  const PaperParameters& online() const { return state_.online; }
  const PaperParameters& target() const { return state_.target; }
  const PaperParameters& gradients() const { return grad_; }  // running statistics have none: 0

 private:
  void update();  // after every change of the parameters

  PaperLearnerOptions options_;
  PaperState state_;
  PaperParameters grad_;
  PaperNetwork network_;
  PaperNetwork target_network_;
  std::vector<double> losses_;      // not taken yet
  std::vector<float> next_q_;       // [B, A]
  std::vector<float> next_online_;  // [B, A]
  std::vector<float> q_;            // [B, A]
};

}  // namespace graphdrl
