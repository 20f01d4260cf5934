// Everything a training can be told, in one table: flags, config files, help and the run's config.json come from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace graphdrl {

inline constexpr const char* kExplorerPreset = "explorer";
inline constexpr const char* kPaperPreset = "paper";
inline constexpr const char* kRandomStart = "random";
inline constexpr const char* kRollback = "rollback";

// The values, with the defaults of the explorer where both presets take an option. An explorer's train for three
// quarters of an hour on two cores (docs/explorer.md). The paper's are the paper's numbers (section 2.2), and its
// author's code where the paper is silent (docs/paper.md). What each option does, its help says.
struct TrainOptions {
  std::string preset = kExplorerPreset;
  std::uint64_t seed = 1;
  std::int64_t batch_size = 64;            // paper: 32
  std::int64_t replay_capacity = 200'000;  // paper: 100,000
  double learning_rate = 2e-3;             // paper: 1e-3
  std::int64_t checkpoint_every = 20;      // paper: 100
  std::string on_nan = "stop";

  // Of the explorer.
  std::string reveal = "all";
  std::int64_t rounds = 240;
  std::int64_t largest = 26;
  std::int64_t teacher_steps = 2;
  double ranking = 1;
  double lead = 0.6;
  std::int64_t walks = 512;
  std::int64_t updates = 400;

  // Of the paper.
  std::vector<std::string> maps = {"paper:a"};
  std::int64_t episodes = 10'000;
  std::string budget = "25";
  std::string start = kRandomStart;
  std::string reward = "visit_penalty";
  bool end_at_full_coverage = false;
  bool punish_blocked_by_visits = false;
  std::string algorithm = "dqn";
  double discount = 0.99;
  double soft_update = 1e-3;
  double dropout = 0.5;
  std::string device = "cpu";
  std::string precision = "float32";
};

// One option.
template <typename T>
struct OptionField {
  const char* key;  // as in config.json; the flag is the same in kebab-case
  T TrainOptions::*member;
  std::function<void(const std::string& flag, const T& value)> check;  // throws Error, naming the flag
  const char* help;
  std::string_view preset = {};  // that takes it; empty where both do

  bool is_of(std::string_view other) const { return preset.empty() || preset == other; }
};

using AnyOptionField =
    std::variant<OptionField<bool>, OptionField<std::int64_t>, OptionField<std::uint64_t>, OptionField<double>,
                 OptionField<std::string>, OptionField<std::vector<std::string>>>;

// The table, in the order of the help.
const std::vector<AnyOptionField>& option_fields();

// Calls visit(field) for every option.
template <typename Visit>
void for_each_option(const Visit& visit) {
  for (const AnyOptionField& field : option_fields()) std::visit(visit, field);
}

// The flag of a key: "--batch-size".
std::string flag_of(const std::string& key);

// Throws Error, naming the option, on a preset that there is not.
TrainOptions default_options(const std::string& preset);

// Throws Error, naming the option, on a value out of range.
void validate(const TrainOptions& options);

// Options by their keys; those left out are the preset's. Throws Error, naming the source, on an unknown key, on one
// that the preset does not take, on a value of the wrong type and on one out of range.
TrainOptions parse_options(const nlohmann::ordered_json& given, const std::string& source);

// Every option that the preset takes, resolved, by its key.
nlohmann::ordered_json config_json(const TrainOptions& options);

// What config.json holds: the same.
std::string config_text(const TrainOptions& options);
// Throws Error on a missing, unknown or mistyped key and on a value out of range.
TrainOptions read_config(const std::filesystem::path& path);

}  // namespace graphdrl
