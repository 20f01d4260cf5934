#include "graphdrl/train/paper_kernel_learner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "train/tiny_world.h"

namespace graphdrl {
namespace {

TEST(TdTargets, AreWorkedOutByHand) {
  PaperMinibatch batch;
  batch.rewards = {1, 2, 3};
  batch.terminal = {0, 0, 1};
  const std::vector<float> next_q = {1, 5, 2, 0, 7, 1, 7, 3, 9, 9, 9, 9};
  const std::vector<float> chooser = {0, 1, 2, 0, 0, 1, 0, 0, 1, 0, 0, 0};
  // Double DQN: the chooser picks actions 2 and 1; nothing follows a terminal state.
  EXPECT_EQ(td_targets(batch, next_q, chooser, 0.5), (std::vector<float>{1 + 0.5f * 2, 2 + 0.5f * 1, 3}));
  EXPECT_EQ(td_targets(batch, next_q, next_q, 0.5), (std::vector<float>{1 + 0.5f * 5, 2 + 0.5f * 7, 3}));
}

TEST(KeepScale, DropsItsShareAndKeepsTheMean) {
  Rng rng(1);
  const std::vector<float> scale = draw_keep_scale(200, 256, 0.25, rng);
  const auto size = static_cast<double>(scale.size());
  EXPECT_NEAR(static_cast<double>(std::count(scale.begin(), scale.end(), 0.0f)) / size, 0.25, 0.01);
  EXPECT_NEAR(std::accumulate(scale.begin(), scale.end(), 0.0) / size, 1, 0.02);
  EXPECT_EQ(draw_keep_scale(2, 3, 0, rng), std::vector<float>(6, 1.0f));
}

TEST(PaperLearner, LearnsTheExactValuesOfAGraphOfFourNodes) {
  // The way round from node 0; full coverage is terminal and worth 0.1 + 1, so the exact values follow from the end.
  const TinyWorld tiny;
  const std::vector<int> way = {2, 3, 0};  // right, down, left
  PaperMinibatch batch;
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
    PaperKernelLearner learner(
        {.double_dqn = double_dqn, .discount = 0.5, .learning_rate = 1e-3, .soft_update = 0.05, .dropout = 0}, rng);
    for (int step = 0; step < 700; ++step) learner.learn(batch, rng);
    std::vector<float> q(batch.actions.size() * kActionCount);
    PaperNetwork target;
    target.set_parameters(learner.target());
    target.q_values(batch.graphs, batch.x, q);
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

TEST(PaperLearner, MovesTheTargetByTheSoftUpdate) {
  const TinyWorld tiny;
  PaperMinibatch batch;
  batch.graphs.clear();
  add_transition(tiny, {}, 2, batch);
  add_transition(tiny, {2}, 1, batch);
  Rng rng(1);
  PaperKernelLearner learner({.soft_update = 0.25}, rng);
  const PaperParameters before = learner.target();
  const std::span<const float> online = learner.online().values();
  const std::span<const float> target = learner.target().values();
  EXPECT_TRUE(std::ranges::equal(before.values(), online)) << "the target starts as a copy";
  learner.learn(batch, rng);
  for (std::size_t i = 0; i < online.size(); ++i) {
    EXPECT_NEAR(target[i], 0.25 * online[i] + 0.75 * before.values()[i], 1e-6) << i;  // paper, eq. 6
  }
  EXPECT_FALSE(std::ranges::equal(before.values(), online));
  EXPECT_NE(online.back(), before.values().back()) << "batch norm's running statistics, the last values, move too";
}

}  // namespace
}  // namespace graphdrl
