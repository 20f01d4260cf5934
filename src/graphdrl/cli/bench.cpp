#include <fmt/format.h>

#include <array>
#include <memory>

#include "graphdrl/base/parallel.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/eval/bench.h"
#include "graphdrl/eval/statistics.h"
#include "graphdrl/train/learning_step_bench.h"

#ifdef GRAPHDRL_OPENBLAS
#include <cblas.h>
#endif

namespace graphdrl {
namespace {

constexpr std::array kThreadCounts = {1, 2};
constexpr int kRounds = 15;

// OpenBLAS's product on one thread, in builds that have it.
GemmFunction openblas_product() {
#ifdef GRAPHDRL_OPENBLAS
  return [](const GemmShape& shape, const float* a, const float* b, float* c) {
    // OpenBLAS on OpenMP keeps a number of threads for each calling thread.
    thread_local const bool alone = (openblas_set_num_threads(1), true);
    static_cast<void>(alone);
    cblas_sgemm(CblasRowMajor, shape.a_transposed ? CblasTrans : CblasNoTrans, CblasNoTrans, shape.m, shape.n, shape.k,
                1.0f, a, shape.lda, b, shape.n, 0.0f, c, shape.ldc);
  };
#else
  return nullptr;
#endif
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
  json["learning_step_ms"] = Json::object();
  json["products_share"] = Json::object();
  json["gemm_share"] = nullptr;
  for (const int count : kThreadCounts) {
    const LearningStepTime time = time_learning_step(count, openblas_product());
    const std::string key = std::to_string(count);
    json["learning_step_ms"][key] = time.step_ms;
    json["products_share"][key] = time.products_ms / time.step_ms;
    if (time.other_products_ms) json["gemm_share"][key] = *time.other_products_ms / time.step_ms;
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
  line("its products alone", "products_share", 100, " % of it");
  if (!json["gemm_share"].is_null()) line("by OpenBLAS's sgemm", "gemm_share", 100, " % of it");
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
    if (*json) {
      print_json(result);
    } else {
      print_text(format_bench(result));
    }
  });
}

}  // namespace graphdrl
