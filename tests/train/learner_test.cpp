#include "graphdrl/train/kernel_learner.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include "graphdrl/env/episode.h"
#include "graphdrl/nn/features.h"
#include "graphdrl/train/device_learner.h"
#include "graphdrl/train/td_target.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(TdTargets, AreWorkedOutByHand) {
  const TdBatch batch{
      .reward = torch::tensor({1.0f, 2.0f, 3.0f}),
      .terminal = torch::tensor({false, false, true}),
      .next_q = torch::tensor({{1.0f, 5.0f, 2.0f, 0.0f}, {7.0f, 1.0f, 7.0f, 3.0f}, {9.0f, 9.0f, 9.0f, 9.0f}}),
      .chooser = torch::tensor({{0.0f, 1.0f, 2.0f, 0.0f}, {0.0f, 1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f, 0.0f}})};
  // Double DQN: the chooser picks actions 2 and 1; nothing follows a terminal state.
  EXPECT_TRUE(torch::allclose(td_targets(batch, 0.5), torch::tensor({1 + 0.5f * 2, 2 + 0.5f * 1, 3.0f})));
  TdBatch dqn = batch;
  dqn.chooser = dqn.next_q;
  EXPECT_TRUE(torch::allclose(td_targets(dqn, 0.5), torch::tensor({1 + 0.5f * 5, 2 + 0.5f * 7, 3.0f})));
}

TEST(KeepScale, DropsItsShareAndKeepsTheMean) {
  Rng rng(1);
  const torch::Tensor scale = draw_keep_scale(200, 256, 0.25, rng);
  EXPECT_NEAR((scale == 0).to(torch::kFloat).mean().item<double>(), 0.25, 0.01);
  EXPECT_NEAR(scale.mean().item<double>(), 1, 0.02);
  EXPECT_TRUE((draw_keep_scale(2, 3, 0, rng) == 1).all().item<bool>());
}

// A map of four nodes.
struct TinyWorld {
  World world = grid_world("..\n..\n");
  FeatureEncoder encoder{world};
};

// Adds the transition of `action` after `actions` from node 0.
void add_transition(const TinyWorld& tiny, const std::vector<int>& actions, int action, Minibatch& batch) {
  Episode episode(tiny.world, {.budget = 9, .end_at_full_coverage = true});
  episode.reset(0);
  for (const int past : actions) episode.step(past);
  const std::size_t row = batch.x.size();
  batch.graphs.add(tiny.world.graph());
  batch.x.resize(row + 4 * kFeatureCount);
  batch.next_x.resize(row + 4 * kFeatureCount);
  tiny.encoder.encode(episode.position(), std::span(episode.visits()), std::span(batch.x).subspan(row));
  const StepResult step = episode.step(action);
  tiny.encoder.encode(episode.position(), std::span(episode.visits()), std::span(batch.next_x).subspan(row));
  batch.actions.push_back(action);
  batch.rewards.push_back(static_cast<float>(step.reward));
  batch.terminal.push_back(episode.terminal());
}

TEST(Learner, LearnsTheExactValuesOfAGraphOfFourNodes) {
  // The way round from node 0; full coverage is terminal and worth 0.1 + 1, so the exact values follow from the end.
  const TinyWorld tiny;
  const std::vector<int> way = {2, 3, 0};  // right, down, left
  Minibatch batch;
  batch.graphs.clear();
  add_transition(tiny, {}, way[0], batch);
  add_transition(tiny, {way[0]}, way[1], batch);
  add_transition(tiny, {way[0], way[1]}, way[2], batch);
  // Every other action of the three states ends worse; given as terminal, so that their value is their reward.
  for (std::size_t done = 0; done < way.size(); ++done) {
    for (int action = 0; action < kActionCount; ++action) {
      if (action == way[done]) continue;
      add_transition(tiny, std::vector<int>(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(done)), action,
                     batch);
      batch.terminal.back() = 1;
    }
  }
  for (const bool double_dqn : {false, true}) {
    Rng rng(1);
    KernelLearner learner(
        {.double_dqn = double_dqn, .discount = 0.5, .learning_rate = 1e-3, .soft_update = 0.05, .dropout = 0}, rng);
    for (int step = 0; step < 700; ++step) learner.learn(batch, rng);
    std::vector<float> q(batch.actions.size() * kActionCount);
    learner.target().q_values(batch.graphs, batch.x, q);
    const double last = 1.1;
    const double middle = 0.1 + 0.5 * last;
    const double first = 0.1 + 0.5 * middle;
    EXPECT_NEAR(q[0 * 4 + way[0]], first, 0.05);
    EXPECT_NEAR(q[1 * 4 + way[1]], middle, 0.05);
    EXPECT_NEAR(q[2 * 4 + way[2]], last, 0.05);
    for (std::size_t row = 3; row < batch.actions.size(); ++row) {
      EXPECT_NEAR(q[row * 4 + batch.actions[row]], batch.rewards[row], 0.05) << row;
    }
  }
}

TEST(Learner, MovesTheTargetByTheSoftUpdate) {
  const TinyWorld tiny;
  Minibatch batch;
  batch.graphs.clear();
  add_transition(tiny, {}, 2, batch);
  add_transition(tiny, {2}, 1, batch);
  Rng rng(1);
  KernelLearner learner({.soft_update = 0.25}, rng);
  const torch::Tensor before = learner.target().values().clone();
  EXPECT_TRUE(torch::equal(before, learner.online().values())) << "the target starts as a copy";
  learner.learn(batch, rng);
  const torch::Tensor expected = 0.25 * learner.online().values() + 0.75 * before;  // paper, eq. 6
  EXPECT_TRUE(torch::allclose(learner.target().values(), expected, 1e-5, 1e-7));
  EXPECT_FALSE(torch::equal(learner.online().values(), before));
  // Batch norm's running statistics, the last values, move too.
  EXPECT_NE(learner.online().values()[-1].item<float>(), before[-1].item<float>());
}

TEST(Learner, OfLibTorchsOperatorsLearnsWhatTheKernelsLearn) {
  const TinyWorld tiny;
  Minibatch batch;
  batch.graphs.clear();
  for (const int action : {0, 1, 2, 3}) add_transition(tiny, {2}, action, batch);
  for (const bool double_dqn : {false, true}) {
    const LearnerOptions options{.double_dqn = double_dqn, .soft_update = 0.1};
    Rng kernel_rng(1);
    Rng device_rng(1);
    KernelLearner kernel(options, kernel_rng);
    DeviceLearner device(torch::kCPU, options, device_rng);
    for (int step = 0; step < 5; ++step) {
      const double loss = kernel.learn(batch, kernel_rng);
      EXPECT_NEAR(device.learn(batch, device_rng), loss, 1e-3 * loss);
    }
    std::vector<float> q(batch.actions.size() * kActionCount);
    std::vector<float> device_q(q.size());
    kernel.q_values(batch.graphs, batch.x, q);
    device.q_values(batch.graphs, batch.x, device_q);
    for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(device_q[i], q[i], 2e-3);

    // The state of one is a state of the other.
    device.set_state(kernel.state());
    device.q_values(batch.graphs, batch.x, device_q);
    for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(device_q[i], q[i], 1e-4);
    EXPECT_EQ(device.state().adam_steps, 5);
    EXPECT_EQ(device.state().adam_second, kernel.state().adam_second);
  }
}

}  // namespace
}  // namespace graphdrl
