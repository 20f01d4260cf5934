// Tables of options, written to config.json and read from it: what a for_each_…field() table of any preset needs.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"

namespace graphdrl {

// Throws Error where the value is none of the choices.
void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& choices);

template <typename T>
void check_range(const std::string& option, T value, T low, T high) {
  if (value >= low && value <= high) return;
  throw Error({.what = "value out of range",
               .expected = fmt::format("{} to {}", low, high),
               .got = fmt::format("{}", value),
               .where = option});
}

class OptionWriter {
 public:
  template <typename T>
  void operator()(const char* key, const T& value, const char*) {
    json_[key] = value;
  }
  void write(const std::filesystem::path& path) const;

 private:
  nlohmann::ordered_json json_;
};

// Reads a config.json. Throws Error on a missing, unknown or mistyped key.
class OptionReader {
 public:
  explicit OptionReader(const std::filesystem::path& path);

  template <typename T>
  void operator()(const char* key, T& value, const char*) {
    const nlohmann::json& found = find(key);
    if (!has_type_of(found, value)) {
      throw Error({.what = "value of the wrong type", .got = found.dump(), .where = path_ + ": " + key});
    }
    found.get_to(value);
    ++known_;
  }
  void finish() const;

 private:
  const nlohmann::json& find(const char* key) const;
  static bool has_type_of(const nlohmann::json& json, const std::string&) { return json.is_string(); }
  static bool has_type_of(const nlohmann::json& json, bool) { return json.is_boolean(); }
  static bool has_type_of(const nlohmann::json& json, std::int64_t) { return json.is_number_integer(); }
  static bool has_type_of(const nlohmann::json& json, std::uint64_t) { return json.is_number_unsigned(); }
  static bool has_type_of(const nlohmann::json& json, double) { return json.is_number(); }
  static bool has_type_of(const nlohmann::json& json, const std::vector<std::string>&);

  std::string path_;
  nlohmann::json json_;
  std::size_t known_ = 0;
};

// The preset that a run's config.json names. Throws Error where it names none.
std::string preset_of(const std::filesystem::path& config);

}  // namespace graphdrl
