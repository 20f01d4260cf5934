#include "graphdrl/report/metrics_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

// The whole lines of the file that belong to the first `episode` episodes.
std::string lines_until(const std::filesystem::path& path, std::int64_t episode) {
  std::string kept;
  if (!std::filesystem::exists(path)) return kept;
  std::istringstream content(read_file(path));
  for (std::string line; std::getline(content, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object() || !json.contains("episode") || !json["episode"].is_number()) break;
    if (json["episode"].get<std::int64_t>() > episode) break;
    kept += line + '\n';
  }
  return kept;
}

}  // namespace

MetricsFile::MetricsFile(const std::filesystem::path& path, std::int64_t episode) : path_(path) {
  write_file(path, lines_until(path, episode));
  file_.open(path, std::ios::binary | std::ios::app);
}

void MetricsFile::write(const MetricsLine& line) {
  nlohmann::ordered_json json;
  json["episode"] = line.episode;
  json["steps"] = line.steps;
  json["epsilon"] = line.epsilon;
  json["loss"] = std::isnan(line.loss) ? nlohmann::ordered_json() : nlohmann::ordered_json(line.loss);
  json["visited_nodes"] = line.visited_nodes;
  json["coverage"] = line.coverage;
  json["reward"] = line.reward;
  file_ << json.dump() << '\n';
  if (!file_.flush()) throw Error({.what = "cannot write the metrics", .where = path_.string()});
}

}  // namespace graphdrl
