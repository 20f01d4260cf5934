#include "graphdrl/eval/bench.h"

#include <chrono>
#include <cmath>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/nn/grid_episodes.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kEpisodes = 1024;      // side by side
constexpr int kStepsPerVisit = 100;  // of one episode before the next one's turn
constexpr int kRounds = 50;
constexpr int kMoves = 300;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// FNV-1a, word by word.
class Signature {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ULL; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

// Walks one of the episodes side by side by random moves.
struct Runner {
  void begin(GridEpisodes& episodes, int index, const World& world) {
    episodes.begin(index, world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
  }

  Rng rng;
  std::int64_t tenths = 0;  // sum of rewards, in tenths: an integer
};

}  // namespace

EnvironmentBench bench_environment() {
  const World world = load_one_world("paper:a");
  GridEpisodes episodes({.world = world, .budget = Budget::parse("25"), .count = kEpisodes});
  std::vector<Runner> runners;
  for (int i = 0; i < kEpisodes; ++i) {
    runners.push_back({.rng = Rng(derive_seed(1, 0, static_cast<std::uint64_t>(i)))});
    runners.back().begin(episodes, i, world);
  }
  const auto start = Clock::now();
  for (int round = 0; round < kRounds; ++round) {
    episodes.for_each([&](int index) {
      Runner& runner = runners[index];
      for (int i = 0; i < kStepsPerVisit; ++i) {
        if (episodes.over(index)) runner.begin(episodes, index, world);
        episodes.act(index, static_cast<int>(runner.rng.below(kActionCount)));
        runner.tenths += std::lround(10 * episodes.rewards()[index]);
      }
    });
  }
  const double elapsed_s = seconds_since(start);
  Signature signature;
  for (int i = 0; i < kEpisodes; ++i) {
    signature.add(static_cast<std::uint64_t>(episodes.episode(i).position()));
    signature.add(static_cast<std::uint64_t>(runners[i].tenths));
    for (const std::uint32_t visits : episodes.episode(i).visits()) signature.add(visits);
    for (const float value : episodes.observation_of(i)) signature.add(static_cast<std::uint64_t>(value));
  }
  const double steps = static_cast<double>(kEpisodes) * kStepsPerVisit * kRounds;
  return {.steps_per_s = steps / elapsed_s, .signature = signature.value()};
}

namespace {

std::uint64_t signature_of_walks(std::initializer_list<const char*> policies) {
  Signature signature;
  for (const World& world : load_worlds({"paper"})) {
    for (const char* const name : policies) {
      const auto policy = make_policy(name, 1);
      for (const RolloutResult& result : roll_out(world, world.valid_nodes(), {}, *policy)) {
        for (const NodeId node : result.walk) signature.add(static_cast<std::uint64_t>(node));
      }
    }
  }
  return signature.value();
}

}  // namespace

std::uint64_t planner_signature() {
  return signature_of_walks({"random", "random-walk", "dfs", "nearest", "beam", "exact"});
}

std::uint64_t learned_signature() {
  return signature_of_walks({"explorer", "guided"});
}

double bench_move_ms() {
  const World world = load_one_world("paper:a");
  Rng rng(1);
  PaperPolicy policy{PaperParameters(rng)};
  std::vector<double> times_ms;
  Episode episode(world, {});
  episode.reset(0);
  for (int i = 0; i < kMoves; ++i) {
    if (episode.done()) episode.reset(0);
    const Observation observation = episode.observation();
    int action = 0;
    const auto start = Clock::now();
    policy.act({&observation, 1}, {&action, 1});
    times_ms.push_back(1e3 * seconds_since(start));
    episode.step(static_cast<int>(rng.below(kActionCount)));
  }
  return median(times_ms);
}

}  // namespace graphdrl
