// metrics.jsonl: one JSON object per line, the curves of a training without TensorBoard.
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
  // Appends to a file. Drops lines past count `done` first, which a run leaves that is resumed from an older
  // checkpoint. `counter` is what lines are counted by and begin with: "episode". Throws Error if the file cannot be
  // written.
  MetricsFile(const std::filesystem::path& path, std::string counter, std::int64_t done);

  // NaN and infinity become null.
  void write(std::int64_t count, std::span<const Scalar> scalars);

 private:
  std::filesystem::path path_;
  std::string counter_;
  std::ofstream file_;
};

}  // namespace graphdrl
