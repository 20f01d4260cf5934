#include "graphdrl/train/torch/paper_stack.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <thread>

#include "graphdrl/train/paper_kernel_learner.h"
#include "graphdrl/train/seed_runs.h"
#include "train/tiny_world.h"
#include "train/training.h"

namespace graphdrl {
namespace {

// The CPU, and CUDA where there is such a device: what is done together is done by one code on both, but for CUDA's
// graphs and its kernel for GRU cells.
std::vector<std::string> devices() {
  std::vector<std::string> names = {"cpu"};
  if (torch::cuda::is_available()) names.emplace_back("cuda");
  return names;
}

// Random states of a map as a minibatch: the features need not come from a walk.
PaperMinibatch random_minibatch(const World& world, int size, Rng& rng) {
  PaperMinibatch batch;
  batch.graphs.clear();
  const auto nodes = static_cast<std::size_t>(world.graph().node_count());
  for (int i = 0; i < size; ++i) {
    batch.graphs.add(world.graph());
    for (std::size_t j = 0; j < nodes * kPaperFeatureCount; ++j) {
      batch.x.push_back(static_cast<float>(rng.below(5)));
      batch.next_x.push_back(static_cast<float>(rng.below(5)));
    }
    batch.actions.push_back(rng.below(kActionCount));
    batch.rewards.push_back(static_cast<float>(rng.uniform()));
    batch.terminal.push_back(rng.below(4) == 0);
  }
  return batch;
}

// One training: learns `steps` times, and asks for the values of moves after every other step. Its maps are two of
// different sizes. Twelve steps are enough for CUDA to replay graphs.
class Training {
 public:
  Training(std::uint64_t seed, int steps, bool moves) : seed_(seed), steps_(steps), moves_(moves) {}

  void run(const MakePaperLearner& make_learner, const PaperLearnerOptions& options) {
    Rng rng(seed_);
    const std::unique_ptr<PaperLearner> learner = make_learner("cpu", options, rng);
    for (int step = 0; step < steps_; ++step) {
      const World& world = step % 2 == 0 ? large_ : small_;
      const PaperMinibatch batch = random_minibatch(world, 6, rng);
      learner->learn(batch, rng);
      if (step % 3 == 1) take_losses(*learner);
      if (!moves_ || step % 2 == 0) continue;
      q.resize(6 * kActionCount);
      learner->q_values(batch.graphs, batch.x, q);
    }
    take_losses(*learner);
    state = learner->state();
  }

  std::vector<double> losses;
  std::vector<float> q;
  PaperState state;

 private:
  void take_losses(PaperLearner& learner) {
    const std::vector<double> taken = learner.take_losses();
    losses.insert(losses.end(), taken.begin(), taken.end());
  }

  std::uint64_t seed_;
  int steps_;
  bool moves_;
  World large_ = grid_world("...\n.#.\n...\n");
  World small_ = grid_world("..\n..\n");
};

TEST(PaperStack, LearnsWhatEachTrainingLearnsAlone) {
  std::vector<std::pair<std::string, bool>> cases;
  for (const std::string& device : devices()) {
    cases.emplace_back(device, false);
    cases.emplace_back(device, true);
  }
  for (const auto& [device, double_dqn] : cases) {
    SCOPED_TRACE(device);
    const PaperLearnerOptions options{.double_dqn = double_dqn, .soft_update = 0.1};
    // Different seeds; one that never moves, one that leaves early.
    const auto make = [] { return std::vector<Training>{{1, 12, true}, {2, 12, false}, {3, 2, true}, {4, 12, true}}; };
    std::vector<Training> alone = make();
    for (Training& training : alone) training.run(make_paper_cpu_learner, options);

    std::vector<Training> together = make();
    PaperStack stack(torch::Device(device), static_cast<int>(together.size()));
    std::vector<std::thread> threads;
    for (int i = 0; i < std::ssize(together); ++i) {
      threads.emplace_back([&, i] {
        together[i].run(stack.learner_of(i), options);
        stack.leave(i);
      });
    }
    for (std::thread& thread : threads) thread.join();

    for (std::size_t i = 0; i < alone.size(); ++i) {
      ASSERT_EQ(together[i].losses.size(), alone[i].losses.size());
      for (std::size_t step = 0; step < alone[i].losses.size(); ++step) {
        EXPECT_NEAR(together[i].losses[step], alone[i].losses[step], 2e-3 * alone[i].losses[step]) << i << ", " << step;
      }
      ASSERT_EQ(together[i].q.size(), alone[i].q.size());
      for (std::size_t j = 0; j < alone[i].q.size(); ++j) EXPECT_NEAR(together[i].q[j], alone[i].q[j], 5e-3);
      EXPECT_EQ(together[i].state.adam.steps, alone[i].state.adam.steps);
    }
    EXPECT_NE(alone[0].losses[0], alone[1].losses[0]);
  }
}

TEST(PaperStack, TakesAndGivesStates) {
  Rng rng(5);
  PaperKernelLearner kernel({}, rng);
  const World world = grid_world("...\n...\n");
  for (int i = 0; i < 3; ++i) kernel.learn(random_minibatch(world, 4, rng), rng);
  PaperStack stack(torch::kCPU, 2);
  Rng other(6);
  const auto first = stack.learner_of(0)("cpu", {}, other);
  const auto second = stack.learner_of(1)("cpu", {}, other);
  second->set_state(kernel.state());
  const PaperState state = second->state();
  EXPECT_TRUE(std::ranges::equal(state.online.values(), kernel.state().online.values()));
  EXPECT_TRUE(std::ranges::equal(state.target.values(), kernel.state().target.values()));
  EXPECT_EQ(state.adam.exp_avg_sq, kernel.state().adam.exp_avg_sq);
  EXPECT_EQ(state.adam.steps, 3);
  EXPECT_FALSE(std::ranges::equal(first->state().online.values(), state.online.values()));
}

// Whole trainings by the stack: the episodes, steps and about the losses of trainings alone. One has another batch
// size: it cannot be trained together with the others.
TEST(PaperStack, TrainsManySeedsAsSingleRuns) {
  const TemporaryFolder folder;
  std::vector<std::string> names;
  std::vector<PlannedRun> runs;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    TrainOptions options = short_paper();
    options.seed = seed;
    if (seed == 3) options.batch_size /= 2;
    names.push_back(std::to_string(seed));
    train_in(folder / ("alone" + names.back()), options);
    runs.push_back({options, RunDirectory(folder / ("stacked" + names.back()))});
  }
  SideBySide stacked(runs, make_paper_device_learner, make_paper_stack);
  int asked = 0;
  EXPECT_FALSE(stacked.run([&] { return ++asked > 60; }, [](const SideBySideNews&) {}));  // stopped and resumed
  SideBySide resumed(runs, make_paper_device_learner, make_paper_stack);
  ASSERT_TRUE(resumed.run([] { return false; }, [](const SideBySideNews&) {}));
  for (const std::string& name : names) {
    const auto metrics = [&](const std::string& run) {
      return nlohmann::json::parse(read_file(RunDirectory(folder / (run + name)).metrics()));
    };
    const auto alone = metrics("alone");
    const auto together = metrics("stacked");
    EXPECT_EQ(together["steps"], alone["steps"]);
    EXPECT_EQ(together["visited_nodes"], alone["visited_nodes"]) << name;
    EXPECT_NEAR(together["loss"].get<double>(), alone["loss"].get<double>(), 0.02 * alone["loss"].get<double>());
  }
}

}  // namespace
}  // namespace graphdrl
