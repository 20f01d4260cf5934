#include "graphdrl/report/metrics_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "graphdrl/base/note.h"
#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

AppendedFile rewritten(const std::filesystem::path& path, const std::string& content) {
  write_file(path, content);
  return AppendedFile(path);
}

}  // namespace

std::string metrics_until(const std::filesystem::path& path, const std::string& counter, std::int64_t done) {
  std::string kept;
  if (!std::filesystem::exists(path)) return kept;
  std::istringstream content(read_file(path));
  for (std::string line; std::getline(content, line);) {
    const auto json = parse_json_or_discard(line);
    if (!json.is_object() || !json.contains(counter) || !json[counter].is_number()) {
      note(path.string() + ": a damaged line: it and what follows is dropped");
      break;
    }
    if (json[counter].get<std::int64_t>() > done) break;
    kept += line + '\n';
  }
  return kept;
}

MetricsFile::MetricsFile(const std::filesystem::path& path, std::string counter, std::string lines)
    : counter_(std::move(counter)), lines_(std::move(lines)), file_(rewritten(path, lines_)) {}

void MetricsFile::write(std::int64_t count, std::span<const Scalar> scalars) {
  nlohmann::ordered_json json;
  json[counter_] = count;
  for (const Scalar& scalar : scalars) {
    json[scalar.tag] = std::isnan(scalar.value) ? nlohmann::ordered_json() : nlohmann::ordered_json(scalar.value);
  }
  const std::string line = json.dump() + '\n';
  file_.append(line);
  lines_ += line;
}

}  // namespace graphdrl
