// metrics.jsonl: one JSON object per line, the curves of a training without TensorBoard.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "graphdrl/io/file.h"
#include "graphdrl/report/event_writer.h"

namespace graphdrl {

class MetricsFile {
 public:
  // Replaces a file by the lines so far, to which it appends. `counter` is what lines are counted by and begin with:
  // "episode". Throws Error if the file cannot be written.
  MetricsFile(const std::filesystem::path& path, std::string counter, std::string lines);

  // NaN and infinity become null.
  void write(std::int64_t count, std::span<const Scalar> scalars);
  void sync() { file_.sync(); }

  const std::string& lines() const { return lines_; }

 private:
  std::string counter_;
  std::string lines_;
  AppendedFile file_;
};

// The whole lines of a file up to a count; none where it is missing.
std::string metrics_until(const std::filesystem::path& path, const std::string& counter, std::int64_t done);

}  // namespace graphdrl
