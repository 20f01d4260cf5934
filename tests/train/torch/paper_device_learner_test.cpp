#include "graphdrl/train/torch/paper_device_learner.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include "graphdrl/train/paper_kernel_learner.h"
#include "train/tiny_world.h"

namespace graphdrl {
namespace {

TEST(PaperDeviceLearner, LearnsWhatTheKernelsLearn) {
  const TinyWorld tiny;
  PaperMinibatch batch;
  batch.graphs.clear();
  for (const int action : {0, 1, 2, 3}) add_transition(tiny, {2}, action, batch);
  for (const bool double_dqn : {false, true}) {
    const PaperLearnerOptions options{.double_dqn = double_dqn, .soft_update = 0.1};
    Rng kernel_rng(1);
    Rng device_rng(1);
    PaperKernelLearner kernel(options, kernel_rng);
    PaperDeviceLearner device(torch::kCPU, options, device_rng);
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
    EXPECT_EQ(device.state().adam.steps, 5);
    EXPECT_EQ(device.state().adam.exp_avg_sq, kernel.state().adam.exp_avg_sq);
  }
}

}  // namespace
}  // namespace graphdrl
