#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "graphdrl/base/error.h"
#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/machine.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/cli/stop_signals.h"
#include "graphdrl/report/progress.h"
#include "graphdrl/train/tuning.h"

namespace graphdrl {
namespace {

struct TuneCommand {
  std::string rounds = "30x2,6x8";
  TuneOptions options;
  std::string out = "runs/tune";
  std::string resume;
  bool break_lock = false;
  ShareText share;
  bool json = false;
};

std::string name_of(const Setting& setting) {
  if (setting.empty()) return "the paper's";
  std::string name;
  for (const auto& item : setting.items()) {
    const std::string value = item.value().is_string() ? item.value().get<std::string>() : item.value().dump();
    name += fmt::format("{}{} {}", name.empty() ? "" : ", ", item.key(), value);
  }
  return name;
}

Json to_json(const Tuning& tuning) {
  Json rounds = Json::array();
  for (const RoundScores& scores : tuning.scores()) {
    Json settings = Json::array();
    for (const SettingScore& score : scores) {
      settings.push_back({{"number", score.setting},
                          {"setting", tuning.settings()[score.setting]},
                          {"mean", score.over_seeds.mean},
                          {"std", or_null(score.over_seeds.std)},
                          {"by_seed", score.by_seed},
                          {"over_paper", score.over_paper},
                          {"over_paper_errors", or_null(score.over_paper_errors)}});
    }
    rounds.push_back(settings);
  }
  Json effects = Json::array();
  for (const ValueEffect& effect : tuning.effects()) {
    effects.push_back({{"option", effect.option},
                       {"value", effect.value},
                       {"settings", effect.over_settings.count},
                       {"mean", effect.over_settings.mean},
                       {"std", or_null(effect.over_settings.std)}});
  }
  return {{"rounds", rounds}, {"effects", effects}};
}

std::string to_text(const Tuning& tuning) {
  std::string text;
  for (std::size_t round = 0; round < tuning.scores().size(); ++round) {
    text += fmt::format(
        "Round {}: {} seeds of {} episodes; percent of unseen maps visited\n\n"
        "  mean    std  over the paper's (in standard errors, paired by seed), setting\n",
        round + 1, tuning.options().rounds[round].seeds, tuning.options().episodes);
    for (const SettingScore& score : tuning.scores()[round]) {
      const auto& errors = score.over_paper_errors;
      text +=
          fmt::format("{:6.1f} {:>6}  {:>+6.1f} {:>7}  {:02} {}\n", score.over_seeds.mean,
                      or_dash(score.over_seeds.std), score.over_paper, errors ? fmt::format("({:+.1f})", *errors) : "",
                      score.setting, name_of(tuning.settings()[score.setting]));
    }
    text += '\n';
  }
  text += "Means over the settings of round 1 that share a value\n\n  mean    std  settings\n";
  for (const ValueEffect& effect : tuning.effects()) {
    const Summary& summary = effect.over_settings;
    text += fmt::format("{:6.1f} {:>6} {:>9}  {} {}\n", summary.mean, or_dash(summary.std), summary.count,
                        effect.option, effect.value);
  }
  return text;
}

void tune(TuneCommand command, const LearnerSource& learners, Ranks& ranks) {
  command.options.rounds = parse_rounds(command.rounds);
  const std::string folder = command.resume.empty() ? command.out : command.resume;
  if (command.break_lock) ranks.on_first([&] { break_locks(folder); });
  const TaskShare share = command.share.share();
  Tuning tuning =
      command.resume.empty() ? Tuning::start(command.options, folder, learners, ranks) : Tuning::resume(folder, ranks);
  catch_stop_signals();
  ProgressDisplay display("round");
  const bool finished = tuning.run(
      [] { return stop_flag().load(); },
      [&](std::size_t round, const SideBySideNews& news) {
        const std::string line = fmt::format("{}/{}  {} runs done  {:.0f} steps/s", round + 1,
                                             tuning.options().rounds.size(), news.runs_done, news.samples_per_s);
        display.show_line(line, static_cast<double>(news.units_done) / static_cast<double>(news.units));
      },
      learners, {.ranks = ranks, .share = share});
  display.finish();
  if (!finished && command.share.merge && stop_signal() == 0) {
    throw Error({.what = fmt::format("round {} is not whole yet", tuning.scores().size() + 1),
                 .expected = "all shares of it done by --task",
                 .where = folder});
  }
  if (!command.share.task.empty() && stop_signal() == 0) {
    return print_text(fmt::format("Share {} of {} is done{}\n", share.index + 1, share.count,
                                  finished ? "" : ", in this round; the same command begins the next one"));
  }
  if (!finished) {
    print_diagnostic(
        fmt::format("Stopped; everything is saved. To go on:\n  graphdrl tune --resume {}\n", escaped(folder)));
    throw CLI::RuntimeError(128 + stop_signal());
  }
  if (command.json) {
    print_json(to_json(tuning));
  } else {
    print_text(to_text(tuning));
  }
  require_none_left_out(TaskFolder(folder));
}

}  // namespace

void add_tune_command(CLI::App& app, const LearnerSource& learners, Ranks& ranks) {
  CLI::App& command = *app.add_subcommand(
      "tune",
      "Search for better hyper-parameters of the paper's training, by successive halving over settings and seeds");
  const auto options = std::make_shared<TuneCommand>();
  TuneOptions& tuning = options->options;
  command
      .add_option("--rounds", options->rounds,
                  "Settings by seeds of each round; the best go on, beside the paper's, with fresh seeds")
      ->type_name("ROUNDS")
      ->capture_default_str();
  command.add_option("--episodes", tuning.episodes, "Episodes of each training")->capture_default_str();
  const auto add_maps = [&](const std::string& name, auto& count, const std::string& purpose) {
    command.add_option(name, count, "Random maps of 5x5 cells" + purpose)
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
  };
  add_maps("--train-maps", tuning.train_maps, ", for settings that train on many instead of the paper's one");
  add_maps("--validation-maps", tuning.validation_maps, " to compare on, none of them the paper's or to train on");
  add_seed_option(command, tuning.seed, "Of the settings and the trainings");
  command
      .add_option("--device", tuning.device, "cpu or cuda, as of train; cuda trains the seeds of a setting together")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->capture_default_str();
  add_text_option(command, "--out", options->out, "FOLDER", "The folder of the search, new")->capture_default_str();
  const auto above = command.get_options([](CLI::Option* option) { return option->get_name() != "--help"; });
  CLI::Option* const resume = add_text_option(command, "--resume", options->resume, "FOLDER",
                                              "Go on with a search; takes none of the options above");
  for (CLI::Option* const option : above) resume->excludes(option);
  command
      .add_flag("--break-lock", options->break_lock,
                "With --resume: go on at once though a trainer on another host held a run in the last minute")
      ->needs(resume);
  add_share_options(command, options->share);
  command.add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(command);
  add_memory_limit_option(command);
  command.callback([options, &learners, &ranks] { tune(*options, learners, ranks); });
}

}  // namespace graphdrl
