#include "graphdrl/report/metrics_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

// The whole lines of the file up to a count.
std::string lines_until(const std::filesystem::path& path, const std::string& counter, std::int64_t done) {
  std::string kept;
  if (!std::filesystem::exists(path)) return kept;
  std::istringstream content(read_file(path));
  for (std::string line; std::getline(content, line);) {
    const auto json = parse_json_or_discard(line);
    if (!json.is_object() || !json.contains(counter) || !json[counter].is_number()) break;
    if (json[counter].get<std::int64_t>() > done) break;
    kept += line + '\n';
  }
  return kept;
}

}  // namespace

MetricsFile::MetricsFile(const std::filesystem::path& path, std::string counter, std::int64_t done)
    : path_(path), counter_(std::move(counter)) {
  write_file(path, lines_until(path, counter_, done));
  file_.open(path, std::ios::binary | std::ios::app);
}

void MetricsFile::write(std::int64_t count, std::span<const Scalar> scalars) {
  nlohmann::ordered_json json;
  json[counter_] = count;
  for (const Scalar& scalar : scalars) {
    json[scalar.tag] = std::isnan(scalar.value) ? nlohmann::ordered_json() : nlohmann::ordered_json(scalar.value);
  }
  file_ << json.dump() << '\n';
  if (!file_.flush()) throw Error({.what = "cannot write the metrics", .where = path_.string()});
}

}  // namespace graphdrl
