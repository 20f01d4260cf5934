// metrics.jsonl: one JSON object per line, for whoever wants the curves without TensorBoard.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace graphdrl {

// The means over the episodes since the line before; epsilon is the last one's.
struct MetricsLine {
  std::int64_t episode;  // episodes done
  std::int64_t steps;    // of all episodes so far
  double epsilon;
  double loss;  // not a number before learning starts
  double visited_nodes;
  double coverage;  // percent
  double reward;    // of an episode
};

class MetricsFile {
 public:
  // Appends to a file, after dropping the lines past `episode` that a run left behind which was resumed from an older
  // checkpoint. Throws Error where the file cannot be written.
  MetricsFile(const std::filesystem::path& path, std::int64_t episode);

  void write(const MetricsLine& line);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace graphdrl
