// metrics.jsonl: one JSON object per line, for whoever wants the curves without TensorBoard.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "graphdrl/report/event_writer.h"

namespace graphdrl {

class MetricsFile {
 public:
  // Appends to a file, after dropping the lines past count `done` that a run left behind which was resumed from an
  // older checkpoint. `counter` is what lines are counted by and begin with: "episode". Throws Error where the file
  // cannot be written.
  MetricsFile(const std::filesystem::path& path, std::string counter, std::int64_t done);

  // What is not a number becomes null.
  void write(std::int64_t count, std::span<const Scalar> scalars);

 private:
  std::filesystem::path path_;
  std::string counter_;
  std::ofstream file_;
};

}  // namespace graphdrl
