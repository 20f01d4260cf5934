#include "graphdrl/train/tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/world_families.h"
#include "graphdrl/eval/comparison.h"
#include "graphdrl/io/checked_json.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/readers.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kManyMaps = "many";
constexpr int kSide = 5;               // of the maps, as the paper's
constexpr std::uint64_t kPurpose = 7;  // of the random numbers that draw settings
constexpr int kMostRuns = 100'000;

// What a setting draws from; the paper's value among each. Around the paper's, about three times as much or as little;
// batches no larger, so that no setting costs more time than the paper's.
const std::vector<std::pair<const char*, std::vector<Json>>>& search_space() {
  static const std::vector<std::pair<const char*, std::vector<Json>>> space = {
      {"learning_rate", {1e-4, 3e-4, 1e-3, 3e-3}},
      {"discount", {0.9, 0.95, 0.99, 0.999}},
      {"soft_update", {3e-4, 1e-3, 3e-3, 1e-2, 1e-1}},
      {"dropout", {0.0, 0.2, 0.5}},
      {"batch_size", {8, 16, 32}},
      {"reward", {"visit_penalty", "coverage_gain"}},
      {"maps", {"paper:a", kManyMaps}},
  };
  return space;
}

// The value that the paper's setting has.
Json paper_value(const std::string& option) {
  if (option == "maps") return "paper:a";
  return config_json(default_options(kPaperPreset))[option];
}

std::vector<Setting> draw_settings(int count, std::uint64_t seed) {
  Rng rng(derive_seed(seed, kPurpose));
  std::vector<Setting> settings = {Setting::object()};
  std::size_t all = 1;
  for (const auto& [option, values] : search_space()) all *= values.size();
  if (static_cast<std::size_t>(count) > all) {
    throw Error({.what = "more settings than there are",
                 .expected = fmt::format("at most {}", all),
                 .got = std::to_string(count),
                 .where = "--rounds"});
  }
  while (std::ssize(settings) < count) {
    Setting setting = Setting::object();
    for (const auto& [option, values] : search_space()) {
      const Json& value = values[rng.below(static_cast<std::uint32_t>(values.size()))];
      if (value != paper_value(option)) setting[option] = value;
    }
    if (std::find(settings.begin(), settings.end(), setting) == settings.end()) settings.push_back(std::move(setting));
  }
  return settings;
}

std::filesystem::path tune_file(const std::filesystem::path& folder) {
  return folder / "tune.json";
}

// Writes maps of a split where they are not there yet, none of them one that is in `taken`, which they join.
void write_maps(const std::filesystem::path& folder, Split split, int count, std::set<std::vector<bool>>& taken) {
  prepare_folder(folder);
  for (int index = 0, written = 0; written < count; ++index) {
    const World world = split_world({.family = "obstacles", .size = kSide}, split, index);
    if (!taken.insert(world.map()->blocked).second) continue;
    const std::filesystem::path file = folder / fmt::format("map-{:03}.txt", written++);
    const std::string map = format_ascii_map(*world.map());
    if (!std::filesystem::exists(file) || read_file(file) != map) write_file(file, map);
  }
}

// The same maps for the same options.
void write_maps(const TuneOptions& options, const std::filesystem::path& folder) {
  std::set<std::vector<bool>> taken;
  for (const World& world : load_worlds({"paper"})) taken.insert(world.map()->blocked);
  write_maps(folder / "maps" / "validation", Split::kValidation, options.validation_maps, taken);
  write_maps(folder / "maps" / "train", Split::kTrain, options.train_maps, taken);
}

TrainOptions options_of(const TuneOptions& options, const Setting& setting, const std::filesystem::path& train_maps) {
  Json json = {{"preset", kPaperPreset}, {"episodes", options.episodes}, {"device", options.device}};
  json.update(setting);
  if (setting.contains("maps")) json["maps"] = {train_maps.string()};
  return parse_options(json, "tune");
}

Json to_json(const TuneOptions& options) {
  Json rounds = Json::array();
  for (const TuneRound& round : options.rounds) rounds.push_back({round.settings, round.seeds});
  return {{"rounds", rounds},
          {"episodes", options.episodes},
          {"train_maps", options.train_maps},
          {"validation_maps", options.validation_maps},
          {"seed", options.seed},
          {"device", options.device}};
}

}  // namespace

std::vector<TuneRound> parse_rounds(const std::string& text) {
  const auto refuse = [&] {
    throw Error({.what = "bad rounds",
                 .expected = "settings by seeds, ever fewer settings, as 30x2,6x8",
                 .got = in_quotes(text, 200),
                 .where = "--rounds"});
  };
  const char* next = text.data();
  const char* const end = next + text.size();
  const auto number = [&] {
    int value = 0;
    const auto [after, error] = std::from_chars(next, end, value);
    if (error != std::errc() || value < 1 || value > kMostRuns) refuse();
    next = after;
    return value;
  };
  std::vector<TuneRound> rounds;
  while (true) {
    TuneRound round{.settings = number(), .seeds = 0};
    if (next == end || *next++ != 'x') refuse();
    round.seeds = number();
    if (std::int64_t{round.settings} * round.seeds > kMostRuns) refuse();
    if (!rounds.empty() && round.settings > rounds.back().settings) refuse();
    rounds.push_back(round);
    if (next == end) return rounds;
    if (*next++ != ',') refuse();
  }
}

Tuning::Tuning(TuneOptions options, std::vector<Setting> settings, std::filesystem::path folder)
    : options_(std::move(options)), settings_(std::move(settings)), folder_(std::move(folder)) {}

Tuning Tuning::start(const TuneOptions& options, std::filesystem::path folder, const LearnerSource& learners,
                     Ranks& ranks) {
  Trainer::check(options_of(options, Setting::object(), ""), learners);  // refuses what all would
  std::vector<Setting> settings = draw_settings(options.rounds.front().settings, options.seed);
  claim_folder(tune_file(folder), {{"options", to_json(options)}, {"settings", settings}}, ranks);
  ranks.on_first([&] { write_maps(options, folder); });
  return {options, std::move(settings), std::move(folder)};
}

Tuning Tuning::resume(std::filesystem::path folder, Ranks& ranks) {
  const std::string source = tune_file(folder).string();
  const Json json = read_checked_json(source);
  try {
    const Json& given = json.at("options");
    TuneOptions options{.rounds = {},
                        .episodes = given.at("episodes"),
                        .train_maps = given.at("train_maps"),
                        .validation_maps = given.at("validation_maps"),
                        .seed = given.at("seed"),
                        .device = given.value("device", "cpu")};
    std::string rounds;
    for (const Json& round : given.at("rounds")) {
      rounds += fmt::format("{}{}x{}", rounds.empty() ? "" : ",", round.at(0).get<int>(), round.at(1).get<int>());
    }
    options.rounds = parse_rounds(rounds);
    std::vector<Setting> settings = json.at("settings").get<std::vector<Setting>>();
    if (settings.empty() || settings.front() != Setting::object()) {
      throw Error({.what = "the first setting is not the paper's", .where = source});
    }
    for (const Setting& setting : settings) options_of(options, setting, folder / "maps" / "train");
    ranks.on_first([&] { write_maps(options, folder); });  // a kill may have come between
    return {std::move(options), std::move(settings), std::move(folder)};
  } catch (const Json::exception& error) {
    throw Error(
        {.what = fmt::format("not a search for hyper-parameters ({})", escaped(error.what())), .where = source});
  }
}

// The paper's, then the others: all of them, or the best of the round before.
std::vector<std::size_t> Tuning::settings_of(std::size_t round) const {
  std::vector<std::size_t> chosen = {0};
  const std::size_t known = round == 0 ? settings_.size() : scores_[round - 1].size();
  const std::size_t count = std::min(known, static_cast<std::size_t>(options_.rounds[round].settings));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t setting = round == 0 ? i : scores_[round - 1][i].setting;
    if (setting != 0) chosen.push_back(setting);
  }
  return chosen;
}

std::vector<PlannedRun> Tuning::runs_of(std::size_t round) const {
  std::vector<PlannedRun> runs;
  std::uint64_t used = 0;  // seeds, in the rounds before
  for (std::size_t before = 0; before < round; ++before)
    used += static_cast<std::uint64_t>(options_.rounds[before].seeds);
  for (const std::size_t setting : settings_of(round)) {
    TrainOptions options = options_of(options_, settings_[setting], folder_ / "maps" / "train");
    for (int i = 0; i < options_.rounds[round].seeds; ++i) {
      options.seed = derive_seed(options_.seed, kPurpose, 1 + used + static_cast<std::uint64_t>(i));
      runs.push_back({options, RunDirectory(folder_ / fmt::format("round-{}", round + 1) /
                                            fmt::format("setting-{:02}", setting) / fmt::format("seed-{}", i + 1))});
    }
  }
  return runs;
}

bool Tuning::run(const std::function<bool()>& stop,
                 const std::function<void(std::size_t round, const SideBySideNews&)>& tell,
                 const LearnerSource& learners, const TaskWorkers& workers) {
  for (std::size_t round = scores_.size(); round < options_.rounds.size(); ++round) {
    SideBySide trainings(runs_of(round), folder_);
    if (!trainings.run(
            stop, [&](const SideBySideNews& news) { tell(round, news); }, learners, workers)) {
      return false;
    }
    if (!workers.share.all()) {
      for (std::size_t run = 0; run < trainings.runs().size(); ++run) {
        if (!trainings.is_trained(run) && !trainings.is_left_out(run)) return false;  // another share's
      }
    }
    std::optional<RoundScores> scores = score(round, trainings, stop, workers.ranks);
    if (!scores) return false;
    scores_.push_back(std::move(*scores));
  }
  return true;
}

std::vector<double> Tuning::scores_by_seed(std::span<const PlannedRun> runs, const std::vector<World>& worlds) const {
  ComparisonOptions comparison{.policies = {}, .all_starts = true};
  comparison.budget = Budget::parse(default_options(kPaperPreset).budget);
  for (const PlannedRun& run : runs) comparison.policies.push_back(run.directory.policy().string());
  std::vector<double> by_seed;
  for (const ComparisonOverall& of_seed : compare(worlds, comparison).overall) by_seed.push_back(*of_seed.mean);
  return by_seed;
}

std::optional<RoundScores> Tuning::score(std::size_t round, const SideBySide& trainings,
                                         const std::function<bool()>& stop, Ranks& ranks) const {
  const std::vector<World> worlds = load_worlds({(folder_ / "maps" / "validation").string()});
  const auto seeds = static_cast<std::size_t>(options_.rounds[round].seeds);
  const std::vector<std::size_t> settings = settings_of(round);
  std::vector<std::string> names;
  names.reserve(settings.size());
  for (const std::size_t setting : settings) names.push_back(fmt::format("setting-{:02}", setting));
  std::atomic<bool> stopped = false;
  const auto results = results_of(names, nullptr, {.ranks = ranks}, [&](int place) -> Json {
    if (stop()) stopped = true;
    const std::size_t first = static_cast<std::size_t>(place) * seeds;
    for (std::size_t run = first; run < first + seeds; ++run) {
      if (stopped || !trainings.is_trained(run)) return Json::array();
    }
    return scores_by_seed(std::span(trainings.runs()).subspan(first, seeds), worlds);
  });
  if (ranks.any(stopped)) return std::nullopt;
  std::vector<std::vector<double>> by_seed;
  for (const Json& of_setting : results.value()) by_seed.push_back(of_setting);
  if (by_seed.front().empty()) {
    throw Error({.what = "trainings by the paper's values failed: there is nothing to compare with",
                 .where = (folder_ / "failed").string()});
  }
  RoundScores scores;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    if (by_seed[i].empty()) continue;
    const PairedDifference difference = paired_difference(by_seed[i], by_seed.front());
    scores.push_back({.setting = settings[i],
                      .by_seed = by_seed[i],
                      .over_seeds = summarise(by_seed[i]),
                      .over_paper = difference.mean,
                      .over_paper_errors = difference.in_errors});
  }
  std::stable_sort(scores.begin(), scores.end(),
                   [](const auto& one, const auto& other) { return one.over_seeds.mean > other.over_seeds.mean; });
  return scores;
}

std::vector<ValueEffect> Tuning::effects() const {
  std::vector<ValueEffect> effects;
  for (const auto& [option, values] : search_space()) {
    for (const Json& value : values) {
      std::vector<double> means;
      for (const SettingScore& score : scores_.front()) {
        if (settings_[score.setting].value(option, paper_value(option)) == value) {
          means.push_back(score.over_seeds.mean);
        }
      }
      if (means.empty()) continue;
      effects.push_back({.option = option,
                         .value = value.is_string() ? value.get<std::string>() : value.dump(),
                         .over_settings = summarise(means)});
    }
  }
  return effects;
}

}  // namespace graphdrl
