// graphdrl-train: what `graphdrl train` becomes. The only program that links LibTorch.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <map>
#include <memory>
#include <sstream>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/train/learning_step_bench.h"
#include "graphdrl/train/trainer.h"

namespace graphdrl {
namespace {

std::atomic<int> stop_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler writes it");

extern "C" void remember_signal(int signal) {
  stop_signal = signal;
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = remember_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
}

std::string kebab_case(std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  return key;
}

// Reads --config files: a run's config.json, or CLI11's own format (name = value).
class ConfigReader : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::stringstream content;
    content << input.rdbuf();
    if ((content >> std::ws).peek() != '{') return CLI::ConfigTOML::from_config(content);
    const Json json = Json::parse(content.str(), nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) throw Error({.what = "the configuration is not valid JSON", .where = "--config"});
    std::vector<CLI::ConfigItem> result;
    for (const auto& [key, value] : json.items()) {
      CLI::ConfigItem item;
      item.name = kebab_case(key);
      for (const Json& one : value.is_array() ? value : Json::array({value})) {
        item.inputs.push_back(one.is_string() ? one.get<std::string>() : one.dump());
      }
      result.push_back(std::move(item));
    }
    return result;
  }
};

struct TrainCommand {
  TrainOptions options;
  std::string out;
  std::string resume;
  bool json = false;
};

void add_field(CLI::App& app, const std::string& flag, std::uint64_t& value, const char* help) {
  app.add_option(flag, value, help)->check(CLI::NonNegativeNumber)->capture_default_str();
}

void add_field(CLI::App& app, const std::string& flag, bool& value, const char* help) {
  app.add_flag(flag, value, help)->capture_default_str();
}

template <typename T>
void add_field(CLI::App& app, const std::string& flag, T& value, const char* help) {
  app.add_option(flag, value, help)->capture_default_str();
}

std::unique_ptr<Trainer> make_trainer(const TrainCommand& command) {
  if (!command.resume.empty()) return Trainer::resume(RunDirectory(command.resume));
  const std::string out = command.out.empty() ? "runs/" + command.options.preset : command.out;
  return Trainer::start(command.options, RunDirectory(out));
}

void train(const TrainCommand& command) {
  const std::unique_ptr<Trainer> trainer = make_trainer(command);
  const std::string run = trainer->run_directory().path().string();
  catch_signals();
  ProgressDisplay display(stderr, trainer->progress().episode);
  const bool finished = trainer->run([] { return stop_signal != 0; }, display);
  const TrainingProgress& progress = trainer->progress();
  if (!finished) {
    print_diagnostic(
        fmt::format("Stopped after {} of {} episodes; everything is saved. To go on:\n  graphdrl train --resume {}\n",
                    progress.episode, trainer->options().episodes, run));
    throw CLI::RuntimeError(128 + stop_signal);
  }
  const std::string policy = trainer->run_directory().policy().string();
  if (command.json) {
    print_json({{"run", run},
                {"episodes", progress.episode},
                {"steps", progress.steps},
                {"elapsed_s", progress.elapsed_s},
                {"policy", policy}});
  } else {
    print_text(fmt::format("Trained {} episodes, {} steps, in {:.0f} s. The policy: {}\n", progress.episode,
                           progress.steps, progress.elapsed_s, policy));
  }
}

int main_program(int argc, char** argv) {
  CLI::App app{
      "Train a policy, and write a run directory with all that is needed to use it, watch it and go on with it.",
      "graphdrl train"};
  const auto command = std::make_shared<TrainCommand>();
  for_each_field(command->options, [&](const char* key, auto& value, const char* help) {
    add_field(app, "--" + kebab_case(key), value, help);
  });
  app.add_option("--out", command->out, "The run directory, new (default: runs/PRESET)")
      ->type_name("RUN")
      ->check(not_empty());
  const std::vector<CLI::Option*> new_run =
      app.get_options([](CLI::Option* option) { return option->get_name() != "--help"; });
  CLI::Option* const resume =
      app.add_option("--resume", command->resume, "Go on with a run; takes none of the options above")
          ->type_name("RUN")
          ->check(not_empty());
  app.add_flag("--json", command->json, "Print one JSON document when done");
  add_threads_option(app);
  app.set_config("--config", "", "Read options from a run's config.json, or from a file of lines name = value");
  app.config_formatter(std::make_shared<ConfigReader>());
  app.allow_config_extras(CLI::config_extras_mode::error);
  // What `graphdrl bench` runs this program for.
  bool bench = false;
  app.add_flag("--bench-learning-step", bench)->group("");
  app.callback([command, new_run, resume, &bench] {
    if (bench) {
      const LearningStepTime time = time_learning_step(threads());
      print_json({{"learning_step_ms", time.step_ms}, {"products_ms", time.products_ms}, {"sgemm_ms", time.sgemm_ms}});
      return;
    }
    for (const CLI::Option* const option : new_run) {
      if (resume->count() > 0 && option->count() > 0) {
        throw Error({.what = option->get_name() + " does not go with --resume",
                     .expected = "the options that the run was started with",
                     .where = command->resume});
      }
    }
    train(*command);
  });
  return run_program(app, argc, argv);
}

}  // namespace
}  // namespace graphdrl

int main(int argc, char** argv) {
  return graphdrl::main_program(argc, argv);
}
