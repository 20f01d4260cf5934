#include "graphdrl/train/train_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  std::string expected;
  for (const std::string& choice : choices) expected += (expected.empty() ? "" : " or ") + choice;
  throw Error({.what = "bad value", .expected = expected, .got = in_quotes(value), .where = option});
}

template <typename T>
void check_range(const std::string& option, T value, T low, T high) {
  if (value >= low && value <= high) return;
  throw Error({.what = "value out of range",
               .expected = fmt::format("{} to {}", low, high),
               .got = fmt::format("{}", value),
               .where = option});
}

bool has_type_of(const nlohmann::json& json, const std::string&) {
  return json.is_string();
}
bool has_type_of(const nlohmann::json& json, bool) {
  return json.is_boolean();
}
bool has_type_of(const nlohmann::json& json, std::int64_t) {
  return json.is_number_integer();
}
bool has_type_of(const nlohmann::json& json, std::uint64_t) {
  return json.is_number_unsigned();
}
bool has_type_of(const nlohmann::json& json, double) {
  return json.is_number();
}
bool has_type_of(const nlohmann::json& json, const std::vector<std::string>&) {
  return json.is_array() && std::all_of(json.begin(), json.end(), [](const auto& item) { return item.is_string(); });
}

}  // namespace

void validate(const TrainOptions& options) {
  constexpr std::int64_t kMany = 1'000'000'000;
  check_choice("--preset", options.preset, {"paper"});
  check_choice("--reward", options.reward, {"visit_penalty", "coverage_gain"});
  check_choice("--algorithm", options.algorithm, {"dqn", "double_dqn"});
  check_choice("--device", options.device, {"cpu", "cuda"});
  check_range<std::int64_t>("--episodes", options.episodes, 1, kMany);
  check_range<std::int64_t>("--batch-size", options.batch_size, 1, 65'536);
  check_range<std::int64_t>("--replay-capacity", options.replay_capacity, options.batch_size + 1, kMany);
  check_range<std::int64_t>("--checkpoint-every", options.checkpoint_every, 1, kMany);
  check_range("--discount", options.discount, 0.0, 1.0);
  check_range("--learning-rate", options.learning_rate, 0.0, 1e3);
  check_range("--soft-update", options.soft_update, 0.0, 1.0);
  check_range("--dropout", options.dropout, 0.0, 0.99);
  Budget::parse(options.budget);
  if (options.punish_blocked_by_visits && options.reward != "visit_penalty") {
    throw Error({.what = "only the reward visit_penalty punishes anything", .where = "--punish-blocked-by-visits"});
  }
  if (options.maps.empty()) throw Error({.what = "no maps to train on", .where = "--maps"});
}

EpisodeOptions episode_options(const TrainOptions& options, const World& world) {
  return {.budget = Budget::parse(options.budget).cost_in(world),
          .action_space = ActionSpace::kDirections,
          .reward = options.reward == "coverage_gain" ? RewardKind::kCoverageGain : RewardKind::kVisitPenalty,
          .end_at_full_coverage = options.end_at_full_coverage,
          .punish_blocked_by_visits = options.punish_blocked_by_visits};
}

void write_config(const std::filesystem::path& path, const TrainOptions& options) {
  nlohmann::ordered_json json;
  for_each_field(options, [&](const char* key, const auto& value, const char*) { json[key] = value; });
  write_file(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
}

TrainOptions read_config(const std::filesystem::path& path) {
  const auto json = nlohmann::json::parse(read_file(path), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) throw Error({.what = "not a run's configuration", .where = path.string()});
  TrainOptions options;
  std::size_t known = 0;
  for_each_field(options, [&](const char* key, auto& value, const char*) {
    if (!json.contains(key)) throw Error({.what = "missing key " + in_quotes(key), .where = path.string()});
    if (!has_type_of(json[key], value)) {
      throw Error({.what = "value of the wrong type", .got = json[key].dump(), .where = path.string() + ": " + key});
    }
    json[key].get_to(value);
    ++known;
  });
  if (known != json.size()) throw Error({.what = "a key that no option has", .where = path.string()});
  validate(options);
  return options;
}

}  // namespace graphdrl
