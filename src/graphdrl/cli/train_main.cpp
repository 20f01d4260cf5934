// graphdrl-train: what `graphdrl train` becomes. The only program that links LibTorch.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <functional>
#include <map>
#include <memory>
#include <sstream>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/train/explorer_trainer.h"
#include "graphdrl/train/learning_step_bench.h"
#include "graphdrl/train/option_table.h"
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
  ExplorerOptions explorer;
  TrainOptions paper;
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

// Trains to the end, or until a signal comes; either trainer. `count` are the rounds or episodes done.
template <typename T, typename Count>
void train(T& trainer, const TrainCommand& command, const std::string& unit, std::int64_t all, const Count& count) {
  const std::string run = trainer.run_directory().path().string();
  catch_signals();
  ProgressDisplay display(stderr, unit, count());
  if (!trainer.run([] { return stop_signal != 0; }, display)) {
    print_diagnostic(
        fmt::format("Stopped after {} of {} {}s; everything is saved. To go on:\n  graphdrl train --resume {}\n",
                    count(), all, unit, run));
    throw CLI::RuntimeError(128 + stop_signal);
  }
  const std::string policy = trainer.run_directory().policy().string();
  const auto [steps, steps_name, elapsed_s] = [&] {
    if constexpr (std::is_same_v<T, Trainer>) {
      return std::tuple(trainer.progress().steps, "steps", trainer.progress().elapsed_s);
    } else {
      return std::tuple(trainer.progress().states, "states", trainer.progress().elapsed_s);
    }
  }();
  if (command.json) {
    print_json(
        {{"run", run}, {unit + 's', count()}, {steps_name, steps}, {"elapsed_s", elapsed_s}, {"policy", policy}});
  } else {
    print_text(fmt::format("Trained {} {}s, {} {}, in {:.0f} s. The policy: {}\n", count(), unit, steps, steps_name,
                           elapsed_s, policy));
  }
}

void train(Trainer& trainer, const TrainCommand& command) {
  train(trainer, command, "episode", trainer.options().episodes, [&] { return trainer.progress().episode; });
}

void train(ExplorerTrainer& trainer, const TrainCommand& command) {
  train(trainer, command, "round", trainer.options().rounds, [&] { return trainer.progress().round; });
}

void train(TrainCommand& command) {
  if (!command.resume.empty()) {
    const RunDirectory run(command.resume);
    if (preset_of(run.config()) == command.paper.preset) return train(*Trainer::resume(run), command);
    return train(*ExplorerTrainer::resume(run), command);
  }
  const std::string& preset = command.explorer.preset;
  const RunDirectory run(command.out.empty() ? "runs/" + preset : command.out);
  if (preset == command.paper.preset) return train(*Trainer::start(command.paper, run), command);
  train(*ExplorerTrainer::start(command.explorer, run), command);
}

// The flags of two presets: those of one alone, and those of both, which set the explorer's value first.
struct PresetFlags {
  std::vector<CLI::Option*> of_explorer;
  std::vector<CLI::Option*> of_paper;
  std::vector<std::function<void()>> copy_to_paper;  // of those of both, where given
};

PresetFlags add_preset_flags(CLI::App& app, TrainCommand& command) {
  PresetFlags flags;
  std::map<std::string, CLI::Option*> added;
  for_each_explorer_field(command.explorer, [&](const char* key, auto& value, const char* help) {
    const std::string flag = "--" + kebab_case(key);
    add_field(app, flag, value, help);
    added[key] = app.get_option(flag);
  });
  for_each_field(command.paper, [&](const char* key, auto& value, const char* help) {
    const std::string flag = "--" + kebab_case(key);
    if (const auto both = added.find(key); both != added.end()) {
      CLI::Option* const option = both->second;
      added.erase(both);
      if (std::string_view(key) == "preset") return;
      // The default shown is the explorer's.
      option->description(fmt::format("{} (paper: {})", option->get_description(), Json(value).dump()));
      flags.copy_to_paper.push_back([option, &value] {
        if (option->count() > 0) option->results(value);
      });
      return;
    }
    add_field(app, flag, value, help);
    flags.of_paper.push_back(app.get_option(flag)->group("Of the preset paper"));
  });
  for (const auto& [key, option] : added) flags.of_explorer.push_back(option->group("Of the preset explorer"));
  return flags;
}

// An option that only the preset paper has chooses that preset, where none is named. Throws Error on options of another
// one.
void choose_preset(TrainCommand& command, bool named, const PresetFlags& flags) {
  const auto given = [](const std::vector<CLI::Option*>& options) {
    const auto found =
        std::find_if(options.begin(), options.end(), [](const CLI::Option* option) { return option->count() > 0; });
    return found == options.end() ? nullptr : *found;
  };
  std::string& preset = command.explorer.preset;
  const std::string explorer = ExplorerOptions{}.preset;
  const std::string paper = TrainOptions{}.preset;
  check_choice("--preset", preset, {explorer, paper});
  if (!named && given(flags.of_paper) != nullptr) preset = paper;
  const bool is_paper = preset == paper;
  if (const CLI::Option* const other = given(is_paper ? flags.of_explorer : flags.of_paper)) {
    throw Error({.what = fmt::format("{} is no option of the preset {}", other->get_name(), preset),
                 .expected = "--preset " + (is_paper ? explorer : paper)});
  }
  if (!is_paper) return;
  for (const auto& copy : flags.copy_to_paper) copy();
}

int main_program(int argc, char** argv) {
  CLI::App app{
      "Train a policy, and write a run directory with all that is needed to use it, watch it and go on with it.",
      "graphdrl train"};
  const auto command = std::make_shared<TrainCommand>();
  const PresetFlags flags = add_preset_flags(app, *command);
  const CLI::Option* const preset = app.get_option("--preset");
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
  app.callback([command, preset, new_run, flags, resume, &bench] {
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
    if (resume->count() == 0) choose_preset(*command, preset->count() > 0, flags);
    train(*command);
  });
  return run_program(app, argc, argv);
}

}  // namespace
}  // namespace graphdrl

int main(int argc, char** argv) {
  return graphdrl::main_program(argc, argv);
}
