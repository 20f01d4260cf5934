#include "graphdrl/train/torch/paper_stack.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
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

  void run(const LearnerSource& learners, const PaperLearnerOptions& options) {
    Rng rng(seed_);
    const std::unique_ptr<PaperLearner> learner = learners.make("cpu", options, rng);
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

void expect_near(std::span<const float> values, std::span<const float> expected, double tolerance) {
  double largest = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    largest = std::max<double>(largest, std::abs(values[i] - expected[i]));
  EXPECT_LE(largest, tolerance);
}

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
    for (Training& training : alone) training.run(kCpuLearners, options);

    std::vector<Training> together = make();
    auto sources = stack_sources(device, static_cast<int>(together.size()));
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < together.size(); ++i) {
      threads.emplace_back([&, i] {
        together[i].run(*sources[i], options);
        sources[i].reset();
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
      expect_near(together[i].state.online.values(), alone[i].state.online.values(), 5e-3);
      expect_near(together[i].state.target.values(), alone[i].state.target.values(), 5e-3);
    }
    EXPECT_NE(alone[0].losses[0], alone[1].losses[0]);
  }
}

// A state that comes when steps are captured already is the one that learns on.
TEST(PaperStack, TakesAndGivesStates) {
  Rng rng(5);
  PaperKernelLearner kernel({}, rng);
  const World world = grid_world("...\n...\n");
  for (int i = 0; i < 3; ++i) kernel.learn(random_minibatch(world, 4, rng), rng);
  for (const std::string& device : devices()) {
    SCOPED_TRACE(device);
    const auto stack = stack_sources(device, 1);
    Rng other(6);
    const auto learner = stack.front()->make(device, {}, other);
    for (int i = 0; i < 5; ++i) learner->learn(random_minibatch(world, 4, other), other);
    EXPECT_FALSE(std::ranges::equal(learner->state().online.values(), kernel.state().online.values()));
    learner->set_state(kernel.state());
    const PaperState state = learner->state();
    EXPECT_TRUE(std::ranges::equal(state.online.values(), kernel.state().online.values()));
    EXPECT_TRUE(std::ranges::equal(state.target.values(), kernel.state().target.values()));
    EXPECT_EQ(state.adam.exp_avg_sq, kernel.state().adam.exp_avg_sq);
    EXPECT_EQ(state.adam.steps, 3);

    PaperKernelLearner expected({}, rng);
    expected.set_state(state);
    Rng same(7);
    Rng again(7);
    expected.learn(random_minibatch(world, 4, same), same);
    learner->learn(random_minibatch(world, 4, again), again);
    expect_near(learner->state().online.values(), expected.state().online.values(), 1e-4);
    EXPECT_NEAR(learner->take_losses().back(), expected.take_losses().back(), 1e-4);
  }
}

// More losses than the device keeps.
TEST(PaperStack, KeepsLossesUntilTheyAreTaken) {
  const World world = grid_world("..\n..\n");
  for (const std::string& device : devices()) {
    SCOPED_TRACE(device);
    const auto stack = stack_sources(device, 1);
    Rng rng(1);
    Rng same(1);
    const auto learner = stack.front()->make(device, {}, rng);
    PaperKernelLearner kernel({}, same);
    for (int i = 0; i < 70; ++i) {
      learner->learn(random_minibatch(world, 2, rng), rng);
      kernel.learn(random_minibatch(world, 2, same), same);
    }
    const std::vector<double> losses = learner->take_losses();
    const std::vector<double> expected = kernel.take_losses();
    ASSERT_EQ(losses.size(), expected.size());
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(losses[i], expected[i], 5e-3 * expected[i]) << i;
    EXPECT_TRUE(learner->take_losses().empty());
  }
}

// All by stacks, on the CPU too.
class StackedLearners final : public LearnerSource {
 public:
  std::vector<std::unique_ptr<LearnerSource>> make_together(const std::string& device, int trainings) const override {
    return stack_sources(device, trainings);
  }
};

// Whole trainings by the stack: the episodes, steps and about the losses of trainings alone. One has another batch
// size: it cannot be trained together with the others.
TEST(PaperStack, TrainsManySeedsAsSingleRuns) {
  const TemporaryFolder folder;
  const std::vector<std::uint64_t> seeds = {1, 2, 3, 4};
  const auto options_of = [](std::uint64_t seed, const std::string& device) {
    TrainOptions options = short_paper();
    options.seed = seed;
    options.device = device;
    if (seed == 3) options.batch_size /= 2;
    return options;
  };
  const auto metrics = [](const RunDirectory& run) { return nlohmann::json::parse(read_file(run.metrics())); };
  for (const std::string& device : devices()) {
    SCOPED_TRACE(device);
    std::vector<PlannedRun> runs;
    for (const std::uint64_t seed : seeds) {
      runs.push_back({options_of(seed, device), RunDirectory(folder / (device + std::to_string(seed)))});
    }
    const StackedLearners learners;
    SideBySide stacked(runs, folder.path());
    std::atomic<int> asked = 0;
    EXPECT_FALSE(
        stacked.run([&] { return ++asked > 60; }, [](const SideBySideNews&) {}, learners));  // stopped and resumed
    SideBySide resumed(runs, folder.path());
    ASSERT_TRUE(resumed.run([] { return false; }, [](const SideBySideNews&) {}, learners));
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      const RunDirectory alone(folder / (device + "-alone" + std::to_string(seeds[i])));
      train_in(alone.path(), options_of(seeds[i], "cpu"));
      const auto expected = metrics(alone);
      const auto together = metrics(runs[i].directory);
      EXPECT_EQ(together["steps"], expected["steps"]);
      EXPECT_EQ(together["visited_nodes"], expected["visited_nodes"]) << seeds[i];
      EXPECT_NEAR(together["loss"].get<double>(), expected["loss"].get<double>(),
                  0.02 * expected["loss"].get<double>());
    }
  }
}

}  // namespace
}  // namespace graphdrl
