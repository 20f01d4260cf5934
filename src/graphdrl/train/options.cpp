#include "graphdrl/train/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <type_traits>

#include "graphdrl/base/error.h"
#include "graphdrl/env/task.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

using Json = nlohmann::ordered_json;
using O = TrainOptions;

constexpr std::int64_t kMany = 1'000'000'000;
constexpr std::string_view kAddedLater[] = {"precision", "on_nan", "reveal"};  // runs of version 0.1.0 do not name them

template <typename T>
void check_range(const std::string& flag, T value, T low, T high) {
  if (value >= low && value <= high) return;
  throw Error({.what = "value out of range",
               .expected = fmt::format("{} to {}", low, high),
               .got = fmt::format("{}", value),
               .where = flag});
}

// What a value may be.
template <typename T>
auto from_to(T low, T high) {
  return [low, high](const std::string& flag, const T& value) { check_range(flag, value, low, high); };
}

auto whole(std::int64_t low, std::int64_t high) {
  return from_to(low, high);
}

auto one_of(std::vector<std::string> choices) {
  return [choices = std::move(choices)](const std::string& flag, const std::string& value) {
    if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
    throw Error({.what = "bad value",
                 .expected = fmt::format("{}", fmt::join(choices, " or ")),
                 .got = in_quotes(value),
                 .where = flag});
  };
}

constexpr auto anything = [](const std::string&, const auto&) {};

template <typename T, typename Check>
AnyOptionField field(const char* key, T O::*member, const Check& check, const char* help) {
  return OptionField<T>{.key = key, .member = member, .check = check, .help = help};
}

std::vector<AnyOptionField> shared_fields() {
  return {
      field("preset", &O::preset, one_of({kExplorerPreset, kPaperPreset}),
            "What to train: explorer, on random worlds of many kinds, or paper (also chosen by its own options)"),
      field("seed", &O::seed, anything,
            "The same seed gives the same policy file, byte for byte (same build and machine; on the CPU)"),
      field("batch_size", &O::batch_size, whole(1, 65'536), "States or transitions per learning step"),
      field("replay_capacity", &O::replay_capacity, whole(1, kMany), "States or transitions remembered"),
      field("learning_rate", &O::learning_rate, from_to(0.0, 1e3), "Adam's; that of the explorer falls to a fiftieth"),
      field("checkpoint_every", &O::checkpoint_every, whole(1, kMany), "Rounds or episodes between checkpoints"),
      field(
          "on_nan", &O::on_nan, one_of({"stop", kRollback}),
          "When a loss or a weight is not finite: stop, or rollback, which goes back to the last checkpoint and halves "
          "the learning rate, three times at most"),
  };
}

std::vector<AnyOptionField> explorer_fields() {
  return {
      field("reveal", &O::reveal, one_of({"all", "edges"}),
            "What the explorer knows of maps: all, or the edges of nodes visited; values are then what its own walks "
            "bring"),
      field("rounds", &O::rounds, whole(1, kMany),
            "Rounds of walks and updates; the learning rate falls over all of them"),
      field(
          "largest", &O::largest, whole(5, 26),
          "Largest side of training grids (4 to 11, 13, 15, 16, 20, 26); graphs have up to seven times as many nodes"),
      field("teacher_steps", &O::teacher_steps, whole(1, 1000),
            "Steps of the search that values a first visit, for each node left to visit"),
      field("ranking", &O::ranking, from_to(0.0, 1e3),
            "Weight of the loss on which first visit is best, beside that on values"),
      field("lead", &O::lead, from_to(0.0, 1.0), "Share of walks that the network leads"),
      field("walks", &O::walks, whole(1, 1'000'000), "Random walks per round"),
      field("updates", &O::updates, whole(1, 1'000'000), "Learning steps per round"),
  };
}

std::vector<AnyOptionField> paper_fields() {
  return {
      field("maps", &O::maps, anything, "Maps to train on, drawn anew for every episode: paper:a, a file, a folder"),
      field("episodes", &O::episodes, whole(1, kMany), "Episodes; epsilon's schedule spans all of them"),
      field(
          "budget", &O::budget, [](const std::string&, const std::string& value) { Budget::parse(value); },
          "Steps per episode, or a multiple of the valid nodes, as 1.1x"),
      field("start", &O::start, anything, "Where episodes start: random, a node id, or row,col"),
      field("reward", &O::reward, one_of({"visit_penalty", "coverage_gain"}),
            "visit_penalty (paper, eq. 3) or coverage_gain (eq. 2)"),
      field("end_at_full_coverage", &O::end_at_full_coverage, anything,
            "End an episode at full coverage, with a bonus of 1"),
      field("punish_blocked_by_visits", &O::punish_blocked_by_visits, anything,
            "Punish a blocked move by a further 0.1 per visit of the node (with visit_penalty)"),
      field("algorithm", &O::algorithm, one_of({"dqn", "double_dqn"}), "dqn or double_dqn"),
      field("discount", &O::discount, from_to(0.0, 1.0), "Of the next state's value; the paper's alpha"),
      field("soft_update", &O::soft_update, from_to(0.0, 1.0),
            "Share of the online weights in the target's, per step; the paper's beta"),
      field("dropout", &O::dropout, from_to(0.0, 0.99), "Probability to drop a hidden value"),
      field("device", &O::device, one_of({"cpu", "cuda"}),
            "cpu or cuda; cuda needs graphdrl-train and a LibTorch that has it"),
      field("precision", &O::precision, one_of({"float32", "tf32"}),
            "Of cuda's matrix products: float32, or tf32, with factors of 10 bits instead of 23"),
  };
}

template <typename T>
bool has_type_of(const Json& json, const T&) {
  if constexpr (std::is_same_v<T, std::string>) return json.is_string();
  if constexpr (std::is_same_v<T, bool>) return json.is_boolean();
  if constexpr (std::is_same_v<T, std::int64_t>) return json.is_number_integer();
  if constexpr (std::is_same_v<T, std::uint64_t>) return json.is_number_unsigned();
  if constexpr (std::is_same_v<T, double>) return json.is_number();
  return json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& item) { return item.is_string(); });
}

}  // namespace

const std::vector<AnyOptionField>& option_fields() {
  static const std::vector<AnyOptionField> fields = [] {
    std::vector<AnyOptionField> all = shared_fields();
    const auto add = [&](std::vector<AnyOptionField> more, std::string_view preset) {
      for (AnyOptionField& field : more) {
        std::visit([&](auto& option) { option.preset = preset; }, field);
        all.push_back(std::move(field));
      }
    };
    add(explorer_fields(), kExplorerPreset);
    add(paper_fields(), kPaperPreset);
    return all;
  }();
  return fields;
}

std::string flag_of(const std::string& key) {
  std::string flag = "--" + key;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

TrainOptions default_options(const std::string& preset) {
  one_of({kExplorerPreset, kPaperPreset})("--preset", preset);
  TrainOptions options;
  if (preset == kExplorerPreset) return options;
  options.preset = kPaperPreset;
  options.batch_size = 32;
  options.replay_capacity = 100'000;
  options.learning_rate = 1e-3;
  options.checkpoint_every = 100;
  return options;
}

void validate(const TrainOptions& options) {
  for_each_option([&](const auto& option) {
    if (option.is_of(options.preset)) option.check(flag_of(option.key), options.*option.member);
  });
  // The paper learns once there are more transitions than a batch has.
  const bool paper = options.preset == kPaperPreset;
  check_range("--replay-capacity", options.replay_capacity, options.batch_size + (paper ? 1 : 0), kMany);
  if (options.reveal != "all") {
    const TrainOptions usual;
    const bool other = options.teacher_steps != usual.teacher_steps || options.ranking != usual.ranking;
    if (other) throw Error({.what = "--teacher-steps and --ranking go with --reveal all", .got = options.reveal});
  }
  if (!paper) return;
  if (options.punish_blocked_by_visits && options.reward != "visit_penalty") {
    throw Error({.what = "only the reward visit_penalty punishes anything", .where = "--punish-blocked-by-visits"});
  }
  if (options.precision != "float32" && options.device == "cpu") {
    throw Error({.what = "the cpu multiplies only in float32", .got = options.precision, .where = "--precision"});
  }
  if (options.maps.empty()) throw Error({.what = "no maps to train on", .where = "--maps"});
}

Json config_json(const TrainOptions& options) {
  Json json;
  for_each_option([&](const auto& option) {
    if (option.is_of(options.preset)) json[option.key] = options.*option.member;
  });
  return json;
}

std::string config_text(const TrainOptions& options) {
  return config_json(options).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

TrainOptions parse_options(const Json& given, const std::string& source) {
  if (!given.is_object()) throw Error({.what = "not a run's configuration", .where = source});
  const auto read = [&](const std::string& key, auto& value) {
    const Json& found = given[key];
    if (!has_type_of(found, value)) {
      throw Error({.what = "value of the wrong type", .got = in_quotes(found.dump()), .where = source + ": " + key});
    }
    found.get_to(value);
  };
  std::string preset = kExplorerPreset;
  if (given.contains("preset")) read("preset", preset);
  TrainOptions options = default_options(preset);
  for (const auto& item : given.items()) {
    bool taken = false;
    for_each_option([&](const auto& option) {
      if (option.key != item.key() || !option.is_of(preset)) return;
      read(item.key(), options.*option.member);
      taken = true;
    });
    if (taken) continue;
    throw Error({.what = "no option of the preset " + preset, .got = in_quotes(item.key(), 200), .where = source});
  }
  validate(options);
  return options;
}

TrainOptions read_config(const std::filesystem::path& path) {
  const std::string source = path.string();
  const std::string text = read_file(path);
  require_shallow_json(text, source);
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  TrainOptions options = parse_options(json, source);
  for_each_option([&](const auto& option) {
    if (!option.is_of(options.preset) || json.contains(option.key)) return;
    if (std::ranges::find(kAddedLater, option.key) != std::end(kAddedLater)) return;
    throw Error({.what = "missing key " + in_quotes(option.key), .where = source});
  });
  return options;
}

}  // namespace graphdrl
