#include "graphdrl/train/option_table.h"

#include <algorithm>

namespace graphdrl {

void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  std::string expected;
  for (const std::string& choice : choices) expected += (expected.empty() ? "" : " or ") + choice;
  throw Error({.what = "bad value", .expected = expected, .got = in_quotes(value), .where = option});
}

void OptionWriter::write(const std::filesystem::path& path) const {
  write_file(path, json_.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
}

OptionReader::OptionReader(const std::filesystem::path& path)
    : path_(path.string()), json_(nlohmann::json::parse(read_file(path), nullptr, /*allow_exceptions=*/false)) {
  if (!json_.is_object()) throw Error({.what = "not a run's configuration", .where = path_});
}

void OptionReader::finish() const {
  if (known_ != json_.size()) throw Error({.what = "a key that no option has", .where = path_});
}

const nlohmann::json& OptionReader::find(const char* key) const {
  if (!json_.contains(key)) throw Error({.what = "missing key " + in_quotes(key), .where = path_});
  return json_[key];
}

bool OptionReader::has_type_of(const nlohmann::json& json, const std::vector<std::string>&) {
  return json.is_array() && std::all_of(json.begin(), json.end(), [](const auto& item) { return item.is_string(); });
}

std::string preset_of(const std::filesystem::path& config) {
  const auto json = nlohmann::json::parse(read_file(config), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("preset") || !json["preset"].is_string()) {
    throw Error({.what = "not a run's configuration", .expected = "a preset", .where = config.string()});
  }
  return json["preset"];
}

}  // namespace graphdrl
