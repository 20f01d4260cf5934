#include "graphdrl/train/learning_step_bench.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/nn/gemm.h"
#include "graphdrl/train/paper_kernel_learner.h"
#include "graphdrl/train/paper_minibatch.h"

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

PaperReplayBuffer random_replay(const World& world, Rng& rng) {
  PaperReplayBuffer replay(100'000, static_cast<std::size_t>(world.graph().node_count()));
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

// Our own product, packing its right operand, as other libraries do.
void own_gemm(const GemmShape& shape, const float* a, const float* b, float* c) {
  gemm(shape.a_transposed ? Op::kTranspose : Op::kNone, Op::kNone, shape.m, shape.n, shape.k, a, shape.lda, b, shape.n,
       false, c, shape.ldc);
}

// Runs products of given shapes, each independent of the others. Operands start all over 2 MB, small enough for the
// caches to hold them: what is left is the products alone.
class GemmReplay {
 public:
  GemmReplay(std::vector<GemmShape> shapes, int threads)
      : shapes_(std::move(shapes)), inputs_(kArena, 0.01f), outputs_(threads, std::vector<float>(kArena)) {}

  // Each worker writes to outputs of its own, and takes the next product when it is done with one.
  void run(GemmFunction product) {
    std::atomic<std::size_t> next = 0;
    parallel_for(static_cast<int>(outputs_.size()), [&](int worker) {
      for (std::size_t i = next++; i < shapes_.size(); i = next++) {
        product(shapes_[i], inputs_.data() + place(3 * i + 1), inputs_.data() + place(3 * i + 2),
                outputs_[worker].data() + place(3 * i));
      }
    });
  }

 private:
  static constexpr std::size_t kArena = std::size_t{1} << 20;    // floats
  static constexpr std::size_t kLargest = std::size_t{1} << 19;  // no operand is larger
  static constexpr std::size_t kStride = 51'200;                 // from one operand to the next
  static std::size_t place(std::size_t operand) { return operand * kStride % (kArena - kLargest); }

  std::vector<GemmShape> shapes_;
  std::vector<float> inputs_;
  std::vector<std::vector<float>> outputs_;  // by worker
};

}  // namespace

LearningStepTime time_learning_step(int threads, GemmFunction other) {
  const World world = load_one_world("paper:a");
  const std::vector<PaperFeatureEncoder> encoders = {PaperFeatureEncoder(world)};
  Rng rng(1);
  const PaperReplayBuffer replay = random_replay(world, rng);
  PaperKernelLearner learner({}, rng);
  PaperMinibatch batch;
  const auto step = [&] {
    sample_minibatch(replay, encoders, kBatchSize, rng, batch);
    learner.learn(batch, rng);
  };
  std::vector<GemmShape> shapes;
  set_threads(1);
  step();
  gemm_log = &shapes;
  step();
  gemm_log = nullptr;
  GemmReplay replayed(shapes, threads);

  set_threads(threads);
  std::vector<double> step_ms;
  std::vector<double> products_ms;
  std::vector<double> other_ms;
  for (int round = 0; round < kRounds; ++round) {
    step_ms.push_back(time_ms(step));
    products_ms.push_back(time_ms([&] { replayed.run(own_gemm); }));
    if (other != nullptr) other_ms.push_back(time_ms([&] { replayed.run(other); }));
  }
  LearningStepTime time{.step_ms = median(step_ms), .products_ms = median(products_ms), .other_products_ms = {}};
  if (other != nullptr) time.other_products_ms = median(other_ms);
  return time;
}

}  // namespace graphdrl
