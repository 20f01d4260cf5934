// Everything a training can be told, in one table: flags, config files, help and the run's config.json come from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace graphdrl {

inline constexpr const char* kExplorerPreset = "explorer";
inline constexpr const char* kPaperPreset = "paper";
inline constexpr const char* kRandomStart = "random";

// The values, resolved. An option that the preset does not take stays empty. Defaults: default_options().
struct TrainOptions {
  std::string preset;
  std::uint64_t seed = 0;
  std::int64_t batch_size = 0;
  std::int64_t replay_capacity = 0;
  double learning_rate = 0;
  std::int64_t checkpoint_every = 0;

  // Of the explorer.
  std::int64_t rounds = 0;
  std::int64_t largest = 0;
  std::int64_t teacher_steps = 0;
  double ranking = 0;
  double lead = 0;
  std::int64_t walks = 0;
  std::int64_t updates = 0;

  // Of the paper.
  std::vector<std::string> maps;
  std::int64_t episodes = 0;
  std::string budget;
  std::string start;
  std::string reward;
  bool end_at_full_coverage = false;
  bool punish_blocked_by_visits = false;
  std::string algorithm;
  double discount = 0;
  double soft_update = 0;
  double dropout = 0;
  std::string device;
  std::string precision;
};

// What an option is when nobody gives it. A preset without a default does not take the option.
template <typename T>
struct Defaults {
  std::optional<T> explorer = {};
  std::optional<T> paper = {};

  const std::optional<T>& of(const std::string& preset) const { return preset == kPaperPreset ? paper : explorer; }
};

// One option.
template <typename T>
struct OptionField {
  const char* key;  // as in config.json; the flag is the same in kebab-case
  T TrainOptions::*member;
  Defaults<T> defaults;
  std::function<void(const std::string& flag, const T& value)> check;  // throws Error, naming the flag
  const char* help;
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

// config.json: the same.
void write_config(const std::filesystem::path& path, const TrainOptions& options);
// Throws Error on a missing, unknown or mistyped key and on a value out of range.
TrainOptions read_config(const std::filesystem::path& path);

}  // namespace graphdrl
