#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>

#include "graphdrl/base/error.h"
#include "graphdrl/base/note.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/machine.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/cli/stop_signals.h"
#include "graphdrl/io/checked_json.h"
#include "graphdrl/io/json.h"
#include "graphdrl/report/progress.h"
#include "graphdrl/train/options.h"
#include "graphdrl/train/paper_learner.h"
#include "graphdrl/train/seed_runs.h"
#include "graphdrl/train/trainer.h"

namespace graphdrl {
namespace {

constexpr auto kReplaceBadText = Json::error_handler_t::replace;
constexpr const char* kTorchProgram = "graphdrl-train";

// `train` is what graphdrl-train does unless it is told `tune`.
[[noreturn]] void become_torch_program(const std::string& device, const std::vector<std::string>& arguments) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / kTorchProgram;
  std::vector<char*> argv = {const_cast<char*>(kTorchProgram)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  if (arguments.front() == "train") argv.erase(argv.begin() + 1);
  argv.push_back(nullptr);
  lift_memory_limit();
  execv(program.c_str(), argv.data());
  throw Error({.what = "training on " + device + " needs graphdrl-train beside graphdrl (" + std::strerror(errno) + ")",
               .expected = "a build with LibTorch (scripts/build --torch), or --device cpu",
               .where = program.string()});
}

// Reads --config files: a run's config.json, or CLI11's own format (name = value).
class ConfigReader : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::stringstream content;
    content << input.rdbuf();
    if ((content >> std::ws).peek() != '{') return CLI::ConfigTOML::from_config(content);
    require_shallow_json(content.str(), "--config");
    Json json = Json::parse(content.str(), nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) throw Error({.what = "the configuration is not valid JSON", .where = "--config"});
    take_checksum(json, "--config");  // of seeds.json
    std::vector<CLI::ConfigItem> result;
    for (const auto& [key, value] : json.items()) {
      CLI::ConfigItem item;
      item.name = flag_of(key).substr(2);
      for (const Json& one : value.is_array() ? value : Json::array({value})) {
        item.inputs.push_back(one.is_string() ? one.get<std::string>() : one.dump());
      }
      if (key == "seeds") item.inputs = {fmt::format("{}", fmt::join(item.inputs, ","))};  // of seeds.json
      result.push_back(std::move(item));
    }
    return result;
  }
};

struct TrainCommand {
  TrainOptions given;  // by flags and config files; else defaults: of the explorer, and of the paper's own options
  std::string seeds;
  std::string out;
  std::string resume;
  bool break_lock = false;
  ShareText share;
  bool json = false;
};

// The flags of a training's options, and the presets that have them.
class OptionFlags {
 public:
  OptionFlags(CLI::App& app, TrainOptions& given) : given_(given) {
    for_each_option([&](const auto& option) { add(app, option); });
    preset_ = app.get_option("--preset");
  }

  // The options as given, with the defaults of their preset. If no preset is named, an option that only `paper` has
  // chooses `paper`. Throws Error on options of another preset.
  TrainOptions resolve() const {
    const bool paper_by_option = preset_->count() == 0 && first_given(of_paper_) != nullptr;
    TrainOptions options = default_options(paper_by_option ? kPaperPreset : given_.preset);
    const bool paper = options.preset == kPaperPreset;
    if (const CLI::Option* const other = first_given(paper ? of_explorer_ : of_paper_)) {
      throw Error({.what = fmt::format("{} is no option of the preset {}", other->get_name(), options.preset),
                   .expected = std::string("--preset ") + (paper ? kExplorerPreset : kPaperPreset)});
    }
    for (const auto& copy : copies_) copy(options);
    return options;
  }

 private:
  template <typename T>
  void add(CLI::App& app, const OptionField<T>& option) {
    T& value = given_.*option.member;
    CLI::Option* const flag = add_flag(app, flag_of(option.key), value, option.help)->capture_default_str();
    if (option.preset == kPaperPreset) of_paper_.push_back(flag->group("Of the preset paper"));
    if (option.preset == kExplorerPreset) of_explorer_.push_back(flag->group("Of the preset explorer"));
    const T of_paper = default_options(kPaperPreset).*option.member;
    if (option.preset.empty() && value != of_paper && flag->get_name() != "--preset") {
      flag->description(fmt::format("{} (paper: {})", flag->get_description(), Json(of_paper).dump()));
    }
    copies_.push_back([flag, &value, member = option.member](TrainOptions& options) {
      if (flag->count() > 0) options.*member = value;
    });
  }

  static CLI::Option* add_flag(CLI::App& app, const std::string& name, std::uint64_t& value, const char* help) {
    return app.add_option(name, value, help)->check(whole_number());
  }
  static CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& value, const char* help) {
    return app.add_flag(name, value, help);
  }
  template <typename T>
  static CLI::Option* add_flag(CLI::App& app, const std::string& name, T& value, const char* help) {
    return app.add_option(name, value, help);
  }

  static const CLI::Option* first_given(const std::vector<CLI::Option*>& options) {
    const auto found =
        std::find_if(options.begin(), options.end(), [](const CLI::Option* option) { return option->count() > 0; });
    return found == options.end() ? nullptr : *found;
  }

  TrainOptions& given_;
  const CLI::Option* preset_ = nullptr;
  std::vector<CLI::Option*> of_explorer_;
  std::vector<CLI::Option*> of_paper_;
  std::vector<std::function<void(TrainOptions&)>> copies_;  // of what was given
};

// Says how to go on, and ends with the signal's status.
[[noreturn]] void leave_stopped(const std::string& what, const std::string& run) {
  print_diagnostic(fmt::format("Stopped after {}; everything is saved. To go on:\n  graphdrl train --resume {}\n", what,
                               escaped(run)));
  throw CLI::RuntimeError(128 + stop_signal());
}

Json report_of(const RunDirectory& run, const TrainingProgress& progress, const TrainingUnits& units) {
  return {{"run", run.path().string()},
          {units.name + 's', progress.done},
          {units.samples, progress.samples},
          {"elapsed_s", progress.elapsed_s},
          {"policy", run.policy().string()}};
}

// Trains to the end, or until a signal comes.
void train(Trainer& trainer, bool json) {
  const std::string run = trainer.run_directory().path().string();
  const TrainingProgress& progress = trainer.progress();
  const TrainingUnits& units = trainer.units();
  catch_stop_signals();
  ProgressDisplay display(units.name, progress.done);
  const bool finished = trainer.run([] { return stop_flag().load(); },
                                    [&](const TrainingNews& news) {
                                      const bool last = progress.done == units.count;
                                      display.show(progress.done, units.count, news.status, last);
                                    });
  display.finish();
  if (!finished) leave_stopped(fmt::format("{} of {} {}s", progress.done, units.count, units.name), run);
  if (json) return print_json(report_of(trainer.run_directory(), progress, units));
  print_text(fmt::format("Trained {} {}s, {} {}, in {:.0f} s. The policy: {}\n", progress.done, units.name,
                         progress.samples, units.samples, progress.elapsed_s,
                         escaped(trainer.run_directory().policy().string())));
}

// Of many seeds: those that are trained, and what is lacking.
void report_seeds(SeedRuns& seeds, bool json) {
  SideBySide& trainings = seeds.trainings();
  const TrainingUnits& units = trainings.units();
  Json reports = Json::array();
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < trainings.runs().size(); ++i) {
    const PlannedRun& run = trainings.runs()[i];
    if (!trainings.is_trained(i)) {
      if (!trainings.is_left_out(i)) {
        throw Error({.what = "not trained yet", .where = run.directory.path().string()});
      }
      ++left_out;
      continue;
    }
    reports.push_back({{"seed", run.options.seed}});
    reports.back().update(report_of(run.directory, trainings.progress()[i], units));
  }
  if (json) {
    print_json({{"runs", reports}});
  } else if (!reports.empty()) {
    print_text(fmt::format("Trained {} seeds, {} {}s each. The runs: {} to {}\n", reports.size(), units.count,
                           units.name, escaped(reports.front()["run"].get<std::string>()),
                           escaped(reports.back()["run"].get<std::string>())));
  }
  if (left_out > 0) throw CLI::RuntimeError(kExitBadInput);
}

// The same as train(), of many seeds.
void train(SeedRuns& seeds, const LearnerSource& learners, const TaskWorkers& workers, bool json) {
  SideBySide& trainings = seeds.trainings();
  const TrainingUnits& units = trainings.units();
  std::int64_t before = 0;
  int seeds_done = 0;
  for (const TrainingProgress& progress : trainings.progress()) {
    before += progress.done;
    if (progress.done == units.count) ++seeds_done;
  }
  catch_stop_signals();
  ProgressDisplay display(units.name, before);
  const std::size_t count = trainings.runs().size();
  const bool finished = trainings.run([] { return stop_flag().load(); },
                                      [&](const SideBySideNews& news) {
                                        seeds_done = news.runs_done;
                                        const bool last = news.units_done == news.units;
                                        display.show(news.units_done, news.units,
                                                     fmt::format("{} of {} seeds done  {:.0f} {}/s", seeds_done, count,
                                                                 news.samples_per_s, units.samples),
                                                     last);
                                      },
                                      learners, workers);
  display.finish();
  if (!finished) leave_stopped(fmt::format("{} of {} seeds", seeds_done, count), seeds.folder().string());
  if (workers.share.all()) return report_seeds(seeds, json);
  print_share_done(workers.share);
}

// The parser of the arguments after `train`, and what they say.
class TrainProgram {
 public:
  TrainProgram(const LearnerSource& learners, Ranks& ranks)
      : learners_(learners), ranks_(ranks), flags_(app_, command_.given) {
    add_text_option(app_, "--seeds", command_.seeds, "SEEDS",
                    "Independent runs of many seeds, as 1-8 or 1,4,7-9, each in RUN/seed-N: on the cpu one a thread, "
                    "each with the bytes that it would have alone; on cuda all together");
    add_text_option(app_, "--out", command_.out, "RUN", "The run directory, new (default: runs/PRESET)");
    of_new_runs_ = app_.get_options([](CLI::Option* option) { return option->get_name() != "--help"; });
    resume_ =
        add_text_option(app_, "--resume", command_.resume, "RUN", "Go on with a run; takes none of the options above");
    app_.add_flag("--break-lock", command_.break_lock,
                  "With --resume: go on at once though a trainer on another host held the run in the last minute")
        ->needs(resume_);
    add_share_options(app_, command_.share);
    app_.add_flag("--json", command_.json, "Print one JSON document when done");
    add_threads_option(app_);
    add_memory_limit_option(app_);
    app_.set_config("--config", "", "Read options from a run's config.json, or from a file of lines name = value");
    app_.config_formatter(std::make_shared<ConfigReader>());
    app_.allow_config_extras(CLI::config_extras_mode::error);
    app_.callback([this] { run(); });
  }
  TrainProgram(const TrainProgram&) = delete;

  CLI::App& app() { return app_; }

 private:
  void run() {
    if (resume_->count() > 0) {
      for (const CLI::Option* const option : of_new_runs_) {
        if (option->count() == 0) continue;
        throw Error({.what = option->get_name() + " does not go with --resume",
                     .expected = "the options that the run was started with",
                     .where = command_.resume});
      }
      if (command_.break_lock) ranks_.on_first([&] { break_locks(command_.resume); });
      const bool many = SeedRuns::are_in(command_.resume);
      ranks_.require_same("files in " + command_.resume, many ? "many runs" : "one");
      if (many) {
        SeedRuns runs = SeedRuns::resume(command_.resume);
        return train_seeds(runs);
      }
      require_no_share();
      const RunDirectory run(command_.resume);
      return train_together(ranks_.alone() ? TrainOptions() : Trainer::options_of(run),
                            [&](Ranks& ranks) { train(*Trainer::resume(run, learners_, ranks), command_.json); });
    }
    const TrainOptions options = flags_.resolve();
    command_.share.share();  // throws Error on a bad one
    if (!ranks_.alone()) {
      const bool reads_maps = options.preset == kPaperPreset;
      const Json files = checksums_of(reads_maps ? options.maps : std::vector<std::string>(), {});
      ranks_.require_same("options or maps", config_text(options) + files.dump(-1, ' ', false, kReplaceBadText));
    }
    const std::string out = command_.out.empty() ? "runs/" + options.preset : command_.out;
    if (!command_.seeds.empty()) {
      SeedRuns runs = SeedRuns::start(options, parse_seeds(command_.seeds), out, learners_, ranks_);
      return train_seeds(runs);
    }
    require_no_share();
    train_together(options, [&](Ranks& ranks) {
      train(*Trainer::start(options, RunDirectory(out), learners_, {}, ranks), command_.json);
    });
  }

  void train_seeds(SeedRuns& runs) {
    if (command_.share.merge) return report_seeds(runs, command_.json);
    train(runs, learners_, {.ranks = ranks_, .share = command_.share.share()}, command_.json);
  }

  void require_no_share() const {
    if (command_.share.task.empty() && !command_.share.merge) return;
    throw Error({.what = "one training has no shares", .expected = "--seeds with --task and --merge"});
  }

  // Many ranks share the explorer's training. That of the paper would change by its last digits, and is one rank's.
  void train_together(const TrainOptions& options, const std::function<void(Ranks&)>& train) {
    if (ranks_.alone() || options.preset == kExplorerPreset) return train(ranks_);
    ranks_.on_first([&] {
      note("one training of the preset paper is the work of one rank; --seeds gives work to all");
      train(one_rank());
    });
  }

  const LearnerSource& learners_;
  Ranks& ranks_;
  CLI::App app_{
      "Train a policy, and write a run directory with all that is needed to use it, watch it and go on with it.",
      "graphdrl train"};
  TrainCommand command_;
  OptionFlags flags_;
  std::vector<CLI::Option*> of_new_runs_;
  CLI::Option* resume_ = nullptr;
};

}  // namespace

void add_train_command(CLI::App& app, const LearnerSource& learners, Ranks& ranks) {
  CLI::App* const command =
      app.add_subcommand("train", "Train a policy, and write a run directory (train --help has the options)");
  // It has a parser of its own: CLI11 reads configuration files for whole programs only.
  command->prefix_command();
  command->set_help_flag();
  command->callback([command, &learners, &ranks] {
    const int status = run_train_command(command->remaining(), learners, ranks);
    if (status != kExitDone) throw CLI::RuntimeError(status);
  });
}

int run_train_command(const std::vector<std::string>& arguments, const LearnerSource& learners, Ranks& ranks) {
  TrainProgram program(learners, ranks);
  std::vector<const char*> argv = {"graphdrl train"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  return run_program(program.app(), static_cast<int>(argv.size()), const_cast<char**>(argv.data()));
}

void CpuOrTorchProgram::prepare(const std::string& device) const {
  if (device != "cpu") become_torch_program(device, arguments_);
}

std::unique_ptr<PaperLearner> CpuOrTorchProgram::make(const std::string& device, const PaperLearnerOptions& options,
                                                      Rng& rng) const {
  if (device != "cpu") become_torch_program(device, arguments_);
  return LearnerSource::make(device, options, rng);
}

// Asked first, on the main thread.
std::vector<std::unique_ptr<LearnerSource>> CpuOrTorchProgram::make_together(const std::string& device,
                                                                             int trainings) const {
  if (device != "cpu") become_torch_program(device, arguments_);
  return LearnerSource::make_together(device, trainings);
}

void visit_train_options(const std::function<void(const CLI::App&)>& visit) {
  visit(TrainProgram(kCpuLearners, one_rank()).app());
}

}  // namespace graphdrl
