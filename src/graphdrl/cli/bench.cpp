#include <fmt/format.h>

#include <array>
#include <chrono>
#include <memory>

#include "graphdrl/base/parallel.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/eval/bench.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/train/paper_kernel_learner.h"

namespace graphdrl {
namespace {

constexpr std::array kThreadCounts = {1, 2};
constexpr int kRounds = 15;
constexpr int kSteps = 8;  // learning steps a round
constexpr std::int64_t kBatchSize = 32;
constexpr int kReplayEpisodes = 200;

// Of random moves.
PaperReplayBuffer random_replay(const World& world, Rng& rng) {
  PaperReplayBuffer replay(100'000, static_cast<std::size_t>(world.node_count()));
  Episode episode(world, {});
  for (int i = 0; i < kReplayEpisodes; ++i) {
    episode.reset(world.valid_nodes()[rng.below(static_cast<std::uint32_t>(world.valid_count()))]);
    while (!episode.done()) {
      const std::vector<std::uint32_t> visits = episode.visits();
      const NodeId from = episode.position();
      const auto action = static_cast<std::int32_t>(rng.below(kActionCount));
      const auto reward = static_cast<float>(episode.step(action).reward);
      replay.push({0, from, action, episode.position(), reward, /*terminal=*/false}, visits);
    }
  }
  return replay;
}

// The median time of a learning step of the preset `paper`: sample, features, both forward passes, backward, Adam, soft
// update.
double learning_step_ms() {
  const World world = load_one_world("paper:a");
  const std::vector<PaperFeatureEncoder> encoders = {PaperFeatureEncoder(world)};
  Rng rng(1);
  const PaperReplayBuffer replay = random_replay(world, rng);
  PaperKernelLearner learner({}, rng);
  PaperMinibatch batch;
  std::vector<double> step_ms;
  for (int round = 0; round <= kRounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kSteps; ++i) {
      sample_minibatch(replay, encoders, kBatchSize, rng, batch);
      learner.learn(batch, rng);
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    if (round > 0) step_ms.push_back(elapsed.count() / kSteps);  // the first one finds no memory yet
  }
  return median(step_ms);
}

Json run_bench() {
  std::uint64_t signature = 0;
  std::array<std::vector<double>, kThreadCounts.size()> steps_per_s;
  for (int round = 0; round < kRounds; ++round) {  // alternating, so that a change of the machine's speed affects all
    for (std::size_t i = 0; i < kThreadCounts.size(); ++i) {
      set_threads(kThreadCounts[i]);
      const EnvironmentBench result = bench_environment();
      steps_per_s[i].push_back(result.steps_per_s);
      if (signature != 0 && signature != result.signature) throw std::logic_error("the signature depends on threads");
      signature = result.signature;
    }
  }
  set_threads(1);
  Json json;
  json["signature"] = fmt::format("{:016x}", signature ^ planner_signature());
  json["signature_learned"] = fmt::format("{:016x}", learned_signature());
  for (std::size_t i = 0; i < kThreadCounts.size(); ++i) {
    json["env_steps_per_s"][std::to_string(kThreadCounts[i])] = median(steps_per_s[i]);
  }
  json["move_ms"] = bench_move_ms();
  for (const int count : kThreadCounts) {
    set_threads(count);
    json["learning_step_ms"][std::to_string(count)] = learning_step_ms();
  }
  return json;
}

std::string format_bench(const Json& json) {
  const auto number = [](const Json& value, double scale, const char* unit) {
    return fmt::format("{:.2f}{}", value.get<double>() * scale, unit);
  };
  std::string text = fmt::format("signature             {}\n", json["signature"].get<std::string>());
  text += fmt::format("of learned walks      {}\n", json["signature_learned"].get<std::string>());
  const auto line = [&](const char* name, const char* key, double scale, const char* unit) {
    text += fmt::format("{:20}  {} (1 thread)  {} (2 threads)\n", name, number(json[key]["1"], scale, unit),
                        number(json[key]["2"], scale, unit));
  };
  line("environment steps", "env_steps_per_s", 1e-6, " million/s");
  text += fmt::format("{:20}  {}\n", "choosing one move", number(json["move_ms"], 1, " ms"));
  line("learning step", "learning_step_ms", 1, " ms");
  return text;
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("bench", "Time a fixed workload, and print a signature that changes only when behaviour does");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print one JSON document");
  command->callback([json] {
    const Json result = run_bench();
    if (*json) return print_json(result);
    print_text(format_bench(result));
  });
}

}  // namespace graphdrl
