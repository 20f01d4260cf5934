#include "graphdrl/eval/bench.h"

#include <array>
#include <cmath>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/nn/feature_episodes.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

constexpr int kEpisodes = 1024;      // side by side
constexpr int kStepsPerVisit = 100;  // of one episode before the next one's turn
constexpr int kRounds = 50;
constexpr int kMoves = 300;

// FNV-1a, word by word.
class Signature {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ULL; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

NodeId any_node(const World& world, Rng& rng) {
  return world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))];
}

void add(Signature& signature, std::span<const NodeId> walk) {
  for (const NodeId node : walk) signature.add(static_cast<std::uint64_t>(node));
}

// Walks of the paper's maps, from every start.
void add_paper_walks(Signature& signature, std::initializer_list<const char*> policies) {
  for (const World& world : load_worlds({"paper"})) {
    for (const char* const name : policies) {
      const auto policy = make_policy(name, 1);
      for (const RolloutResult& result : roll_out(Episode(world, {}), world.valid_nodes(), *policy))
        add(signature, result.walk);
    }
  }
}

// The same world with a prize of 0 to 5 for each node.
World with_prizes(const World& world, Rng& rng) {
  std::vector<double> prizes;
  prizes.reserve(world.node_count());
  for (NodeId node = 0; node < world.node_count(); ++node) prizes.push_back(rng.below(6));
  return World(world.name() + "-prizes", world.graph(), world.blocked(), {}, std::move(prizes));
}

// Random worlds with and without costs, directions and prizes, each under two budgets and three kinds of end.
std::vector<Task> random_tasks() {
  constexpr std::array<double, 2> kRatios = {0.4, 1.1};
  const std::vector<WorldSpec> specs = {
      {.family = "loop-maze", .size = 9},
      {.family = "obstacles", .size = 8},
      {.family = "geometric", .size = 40, .weighted = true},
      {.family = "erdos-renyi", .size = 30, .directed = true},
      {.family = "geometric", .size = 30, .weighted = true, .directed = true},
  };
  Rng rng(1);
  std::vector<Task> tasks;
  for (const WorldSpec& spec : specs) {
    const World plain = random_world(spec, rng);
    for (const World& world : {plain, with_prizes(plain, rng)}) {
      for (const double ratio : kRatios) {
        const NodeId start = any_node(world, rng);
        const double budget = std::floor(ratio * world.valid_count() * world.open().mean_cost());
        const NodeId far_end = any_node(world, rng);
        const bool in_reach = costs_to(world.into(), far_end)[start] <= budget;
        for (const NodeId end : {kNoNode, start, in_reach ? far_end : start}) {
          tasks.emplace_back(world, start, budget, end == kNoNode ? End::anywhere() : End::at(end));
        }
      }
    }
  }
  return tasks;
}

void add_random_tasks(Signature& signature, std::initializer_list<const char*> planners) {
  for (const Task& task : random_tasks()) {
    for (const char* const name : planners) add(signature, make_planner(name, 1)->plan(task).walk);
  }
}

}  // namespace

EnvironmentBench bench_environment() {
  const World world = load_one_world("paper:a");
  GridEpisodes episodes({.world = world, .budget = Budget::parse("25"), .count = kEpisodes});
  struct Runner {
    Rng rng;
    std::int64_t tenths = 0;  // sum of rewards, in tenths: an integer
  };
  std::vector<Runner> runners;
  const auto begin = [&](int index) { episodes.begin(index, any_node(world, runners[index].rng)); };
  for (int i = 0; i < kEpisodes; ++i) {
    runners.push_back({.rng = Rng(derive_seed(1, 0, static_cast<std::uint64_t>(i)))});
    begin(i);
  }
  const Stopwatch watch;
  for (int round = 0; round < kRounds; ++round) {
    episodes.for_each([&](int index) {
      Runner& runner = runners[index];
      for (int i = 0; i < kStepsPerVisit; ++i) {
        if (episodes.over(index)) begin(index);
        episodes.act(index, static_cast<int>(runner.rng.below(kActionCount)));
        runner.tenths += std::lround(10 * episodes.rewards()[index]);
      }
    });
  }
  const double elapsed_s = watch.seconds();
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

std::uint64_t planner_signature() {
  Signature signature;
  add_paper_walks(signature, {"random", "random-walk", "dfs", "nearest", "beam", "exact"});
  add_random_tasks(signature, {"dfs", "nearest", "beam"});
  // Prizes are whole numbers, and so is what a bound says of them.
  for (const Task& task : random_tasks()) signature.add(static_cast<std::uint64_t>(max_prize(task) + 1e-6));
  return signature.value();
}

std::uint64_t learned_signature() {
  Signature signature;
  add_paper_walks(signature, {"explorer", "guided"});
  add_random_tasks(signature, {"explorer", "guided", "search:2000"});
  return signature.value();
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
    const Stopwatch watch;
    policy.act({&observation, 1}, {&action, 1});
    times_ms.push_back(1e3 * watch.seconds());
    episode.step(static_cast<int>(rng.below(kActionCount)));
  }
  return median(times_ms);
}

}  // namespace graphdrl
