// What single parts cost, and how that grows with nodes, degree, batch and threads; the tables of docs/performance.md.
//   build/torch/bin/micro_benchmarks --benchmark_filter=LearningStep
// Each case holds its result against an independent one and reports an error where they differ.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/graph/grid_map.h"
#include "graphdrl/nn/gemm.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/train/paper_kernel_learner.h"
#include "graphdrl/train/torch/paper_stack.h"

namespace graphdrl {
namespace {

std::vector<float> random_values(std::size_t count, Rng& rng) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(2 * rng.uniform() - 1);
  return values;
}

// A ring whose nodes also know those up to degree / 2 steps away.
Graph circulant(int nodes, int degree) {
  std::vector<Edge> edges;
  for (int node = 0; node < nodes; ++node) {
    for (int step = 1; step <= degree / 2; ++step) edges.push_back({node, (node + step) % nodes});
  }
  return Graph::from_edges(nodes, edges);
}

// The shapes of the widest layer: a chunk's gates, the way back through them, a weight's gradient.
void BM_Gemm(benchmark::State& state) {
  const int m = static_cast<int>(state.range(0));
  const int n = static_cast<int>(state.range(1));
  const int k = static_cast<int>(state.range(2));
  const Op op = state.range(3) == 0 ? Op::kNone : Op::kTranspose;
  const int lda = op == Op::kNone ? k : m;
  Rng rng(1);
  const std::vector<float> a = random_values(static_cast<std::size_t>(m) * k, rng);
  const std::vector<float> b = random_values(static_cast<std::size_t>(k) * n, rng);
  std::vector<float> c(static_cast<std::size_t>(m) * n);
  PackedMatrix<float> packed;
  packed.set(k, n, Op::kNone, b.data(), n);
  for (auto _ : state) {
    gemm(op, m, n, k, a.data(), lda, packed, false, c.data(), n);
    benchmark::DoNotOptimize(c.data());
  }
  for (int i = 0; i < m; i += 7) {
    for (int j = 0; j < n; ++j) {
      double sum = 0;
      for (int p = 0; p < k; ++p) sum += double{op == Op::kNone ? a[i * k + p] : a[p * m + i]} * b[p * n + j];
      if (!(std::abs(sum - c[i * n + j]) <= 1e-5 * std::sqrt(k))) return state.SkipWithError("wrong product");
    }
  }
  state.counters["GFLOP/s"] =
      benchmark::Counter(2e-9 * m * n * k, benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1000);
}
BENCHMARK(BM_Gemm)
    ->ArgNames({"m", "n", "k", "transposed"})
    ->Args({100, 384, 128, 0})
    ->Args({100, 128, 384, 0})
    ->Args({128, 128, 200, 1})
    ->Args({25, 384, 128, 0});

// One graph, many times, with states drawn at random: a step costs the same for any values.
struct LearningCase {
  LearningCase(Graph of_all, int batch_size) : graph(std::move(of_all)) {
    Rng rng(2);
    for (int i = 0; i < batch_size; ++i) {
      batch.graphs.add(graph);
      batch.actions.push_back(rng.below(kActionCount));
      batch.rewards.push_back(static_cast<float>(rng.uniform()));
      batch.terminal.push_back(0);
    }
    const std::size_t values = static_cast<std::size_t>(batch.graphs.node_count()) * kPaperFeatureCount;
    batch.x = random_values(values, rng);
    batch.next_x = random_values(values, rng);
  }

  Graph graph;
  PaperMinibatch batch;
};

// One learning step of the paper's network; its first loss against LibTorch's own operators.
void time_learning_step(benchmark::State& state, const LearningCase& work, int threads) {
  Rng rng(3);
  Rng rng_of_operators(3);
  PaperKernelLearner learner({}, rng);
  const auto operators = stack_sources("cpu", 1);
  const auto operators_learner = operators.front()->make("cpu", {}, rng_of_operators);
  operators_learner->learn(work.batch, rng_of_operators);
  set_threads(threads);
  learner.learn(work.batch, rng);
  const double loss = learner.take_losses().front();
  for (auto _ : state) learner.learn(work.batch, rng);
  set_threads(1);
  if (!(std::abs(operators_learner->take_losses().front() - loss) <= 1e-3 * loss)) {
    state.SkipWithError("wrong loss");
  }
}

void BM_LearningStepByNodes(benchmark::State& state) {
  time_learning_step(state, LearningCase(circulant(static_cast<int>(state.range(0)), 4), 32), 2);
}
BENCHMARK(BM_LearningStepByNodes)->ArgName("nodes")->ArgsProduct({{25, 50, 100, 200, 400}})->UseRealTime();

void BM_LearningStepByBatch(benchmark::State& state) {
  time_learning_step(state, LearningCase(Graph::grid(5, 5), static_cast<int>(state.range(0))), 2);
}
BENCHMARK(BM_LearningStepByBatch)->ArgName("batch")->RangeMultiplier(2)->Range(8, 512)->UseRealTime();

void BM_LearningStepByDegree(benchmark::State& state) {
  time_learning_step(state, LearningCase(circulant(100, static_cast<int>(state.range(0))), 8), 2);
}
BENCHMARK(BM_LearningStepByDegree)->ArgName("degree")->RangeMultiplier(2)->Range(2, 64)->UseRealTime();

void BM_LearningStepByThreads(benchmark::State& state) {
  time_learning_step(state, LearningCase(Graph::grid(5, 5), 32), static_cast<int>(state.range(0)));
}
BENCHMARK(BM_LearningStepByThreads)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

// Q-values of one state; against LibTorch's own operators.
void BM_QValuesByNodes(benchmark::State& state) {
  const LearningCase work(circulant(static_cast<int>(state.range(0)), 4), 1);
  Rng rng(4);
  const PaperParameters parameters(rng);
  PaperNetwork network;
  network.set_parameters(parameters);
  std::vector<float> q(kActionCount);
  for (auto _ : state) network.q_values(work.batch.graphs, work.batch.x, q);
  Rng rng_of_operators(4);  // the same weights
  const auto operators = stack_sources("cpu", 1);
  std::vector<float> expected(q.size());
  operators.front()->make("cpu", {}, rng_of_operators)->q_values(work.batch.graphs, work.batch.x, expected);
  for (int a = 0; a < kActionCount; ++a) {
    const float value = expected[a];
    if (!(std::abs(q[a] - value) <= 1e-3f * (1 + std::abs(value)))) return state.SkipWithError("wrong values");
  }
}
BENCHMARK(BM_QValuesByNodes)->ArgName("nodes")->ArgsProduct({{25, 50, 100, 200, 400, 1600, 6400}});

// One move each of many episodes on the paper's map a; against moves chosen one by one.
void BM_MovesByEpisodes(benchmark::State& state) {
  const World world = load_one_world("paper:a");
  Rng rng(6);
  PaperPolicy policy{PaperParameters(rng)};
  std::vector<Episode> episodes(static_cast<std::size_t>(state.range(0)), Episode(world, {}));
  for (Episode& episode : episodes) {
    episode.reset(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
    for (int i = 0; i < 10; ++i) episode.step(static_cast<int>(rng.below(kActionCount)));
  }
  std::vector<Observation> observations;
  for (const Episode& episode : episodes) observations.push_back(episode.observation());
  std::vector<int> actions(episodes.size());
  set_threads(2);
  for (auto _ : state) policy.act(observations, actions);
  set_threads(1);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    int action = 0;
    policy.act({&observations[i], 1}, {&action, 1});
    if (action != actions[i]) return state.SkipWithError("wrong move");
  }
  state.counters["moves/s"] =
      benchmark::Counter(static_cast<double>(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_MovesByEpisodes)->ArgName("episodes")->ArgsProduct({{1, 4, 16, 64, 256, 1024}})->UseRealTime();

// Steps of an episode with its features kept up to date; against features built from scratch.
void BM_StepsByNodes(benchmark::State& state) {
  const int side = static_cast<int>(std::lround(std::sqrt(state.range(0))));
  const World world("case", GridMap{.rows = side, .cols = side, .blocked = std::vector<bool>(side * side)});
  const PaperFeatureEncoder encoder(world);
  Episode episode(world, {.budget = 1e9});
  episode.reset(0);
  std::vector<float> features(static_cast<std::size_t>(side) * side * kPaperFeatureCount);
  encoder.begin(0, features);
  Rng rng(5);
  std::int64_t steps = 0;
  for (auto _ : state) {
    if (++steps % 1000 == 0) {
      episode.reset(0);
      encoder.begin(0, features);
    }
    const NodeId from = episode.position();
    const StepResult step = episode.step(static_cast<int>(rng.below(4)));
    encoder.update(from, episode.position(), step, features);
  }
  std::vector<float> expected(features.size());
  encoder.encode(episode.position(), std::span(episode.visits()), expected);
  if (features != expected) state.SkipWithError("wrong features");
}
BENCHMARK(BM_StepsByNodes)->ArgName("nodes")->Arg(25)->Arg(400)->Arg(6400);

}  // namespace
}  // namespace graphdrl

BENCHMARK_MAIN();
