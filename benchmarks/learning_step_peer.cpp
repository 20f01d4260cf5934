// Our side of compare_pyg.py: writes a replay buffer and weights to a file, then times what it is asked to on standard
// input.
//   learning_step_peer FILE THREADS
//   "learn N" samples and learns N times, "move N" chooses N moves; the answer is milliseconds for one.
#include <chrono>
#include <iostream>
#include <string>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/train/paper_kernel_learner.h"

namespace graphdrl {
namespace {

constexpr int kBatchSize = 32;

// Transitions of random moves on the paper's map a.
PaperReplayBuffer random_replay(const World& world, Rng& rng) {
  PaperReplayBuffer replay(1'000, static_cast<std::size_t>(world.graph().node_count()));
  Episode episode(world, {});
  for (int i = 0; i < 1'000; ++i) {
    if (i % 25 == 0) episode.reset(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
    const std::vector<std::uint32_t> visits = episode.visits();
    const NodeId from = episode.position();
    const auto action = static_cast<std::int32_t>(rng.below(kActionCount));
    const auto reward = static_cast<float>(episode.step(action).reward);
    replay.push({0, from, action, episode.position(), reward, false}, visits);
  }
  return replay;
}

// Every transition of the replay buffer, encoded, in its order.
PaperMinibatch whole_replay(const PaperReplayBuffer& replay, const PaperFeatureEncoder& encoder) {
  PaperMinibatch all;
  all.clear();
  for (std::size_t i = 0; i < replay.size(); ++i) append_transition(replay, i, encoder, all);
  return all;
}

int serve(const std::string& file, int threads) {
  Rng rng(7);
  const World world = load_one_world("paper:a");
  const std::vector<PaperFeatureEncoder> encoders = {PaperFeatureEncoder(world)};
  const PaperReplayBuffer replay = random_replay(world, rng);
  PaperKernelLearner learner({}, rng);
  PaperMinibatch batch;  // the first transitions, for the losses to agree on
  batch.clear();
  for (std::size_t i = 0; i < kBatchSize; ++i) append_transition(replay, i, encoders.front(), batch);
  const std::vector<float> keep_scale = draw_keep_scale(kBatchSize, kHiddenWidth, 0.5, rng);
  const PaperParameters weights = learner.online();
  const std::vector<double> loss = {learner.compute_gradients(batch, keep_scale)};

  std::vector<TensorView> tensors = weights.views();
  const PaperMinibatch all = whole_replay(replay, encoders.front());
  const auto size = static_cast<std::int64_t>(all.actions.size());
  const Shape states = {size, world.graph().node_count(), kPaperFeatureCount};
  tensors.emplace_back("x", states, std::span<const float>(all.x));
  tensors.emplace_back("next_x", states, std::span<const float>(all.next_x));
  tensors.emplace_back("actions", Shape{size}, std::span<const std::int64_t>(all.actions));
  tensors.emplace_back("rewards", Shape{size}, std::span<const float>(all.rewards));
  tensors.emplace_back("keep_scale", Shape{kBatchSize, kHiddenWidth}, std::span<const float>(keep_scale));
  tensors.emplace_back("loss", Shape{1}, std::span<const double>(loss));
  write_safetensors(file, tensors, {});

  PaperPolicy policy(weights);
  Episode episode(world, {});
  episode.reset(0);
  const Observation observation = episode.observation();
  set_threads(threads);
  std::string what;
  for (int count = 0; std::cin >> what >> count;) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) {
      int action = 0;
      if (what == "learn") {
        sample_minibatch(replay, encoders, kBatchSize, rng, batch);
        learner.learn(batch, rng);
      }
      if (what == "move") policy.act({&observation, 1}, {&action, 1});
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    std::cout << elapsed.count() / count << std::endl;
  }
  return 0;
}

}  // namespace
}  // namespace graphdrl

int main(int argc, char** argv) {
  return argc == 3 ? graphdrl::serve(argv[1], std::stoi(argv[2])) : 2;
}
