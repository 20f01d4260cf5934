#include "graphdrl/train/learning_step_bench.h"

#include <chrono>
#include <cstdint>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/nn/gemm.h"
#include "graphdrl/train/learner.h"
#include "graphdrl/train/minibatch.h"

namespace graphdrl {
namespace {

constexpr int kRounds = 15;
constexpr int kRepeats = 8;  // per round
constexpr std::int64_t kBatchSize = 32;
constexpr int kReplayEpisodes = 200;

template <typename Work>
double time_ms(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kRepeats; ++i) work();
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / kRepeats;
}

ReplayBuffer random_replay(const World& world, Rng& rng) {
  ReplayBuffer replay(100'000, static_cast<std::size_t>(world.graph().node_count()));
  Episode episode(world, {});
  for (int i = 0; i < kReplayEpisodes; ++i) {
    episode.reset(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
    while (!episode.done()) {
      const std::vector<std::uint32_t> visits = episode.visits();
      const NodeId from = episode.position();
      const auto action = static_cast<std::int32_t>(rng.below(kActionCount));
      const StepResult step = episode.step(action);
      replay.push({.world = 0,
                   .position = from,
                   .action = action,
                   .next_position = episode.position(),
                   .reward = static_cast<float>(step.reward),
                   .terminal = false},
                  visits);
    }
  }
  return replay;
}

// Runs products of given shapes, each independent of the others. Operands start all over 2 MB, small enough for the
// caches to hold them: what is left is the products alone.
class GemmReplay {
 public:
  GemmReplay(std::vector<GemmCall> calls, int threads)
      : calls_(std::move(calls)), inputs_(kArena, 0.01f), outputs_(threads, std::vector<float>(kArena)) {}

  void run() {
    parallel_for(static_cast<int>(calls_.size()), [&](int index) {
      const GemmCall& call = calls_[index];
      float* const c = outputs_[omp_get_thread_num()].data() + place(3 * index);
      gemm(call, inputs_.data() + place(3 * index + 1), inputs_.data() + place(3 * index + 2), c);
    });
  }

 private:
  static constexpr std::size_t kArena = std::size_t{1} << 20;    // floats
  static constexpr std::size_t kLargest = std::size_t{1} << 19;  // no operand is larger
  static std::size_t place(int operand) { return static_cast<std::size_t>(operand) * 51'200 % (kArena - kLargest); }

  std::vector<GemmCall> calls_;
  std::vector<float> inputs_;
  std::vector<std::vector<float>> outputs_;  // by thread
};

}  // namespace

LearningStepTime time_learning_step(int threads) {
  const World world = load_one_world("paper:a");
  const std::vector<FeatureEncoder> encoders = {FeatureEncoder(world)};
  Rng rng(1);
  const ReplayBuffer replay = random_replay(world, rng);
  Learner learner({}, rng);
  Minibatch batch;
  const auto step = [&] {
    sample_minibatch(replay, encoders, kBatchSize, rng, batch);
    learner.learn(batch, rng);
  };
  std::vector<GemmCall> calls;
  set_threads(1);
  step();
  gemm_log = &calls;
  step();
  gemm_log = nullptr;
  GemmReplay products(calls, threads);

  set_threads(threads);
  std::vector<double> step_ms;
  std::vector<double> gemm_ms;
  for (int round = 0; round < kRounds; ++round) {
    step_ms.push_back(time_ms(step));
    gemm_ms.push_back(time_ms([&] { products.run(); }));
  }
  return {.step_ms = median(step_ms), .gemm_ms = median(gemm_ms)};
}

}  // namespace graphdrl
