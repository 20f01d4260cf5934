// Trainings of one configuration by many seeds, side by side. Each has a run directory of its own, FOLDER/seed-N, and
// ends with the bytes that it would have alone.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "graphdrl/train/side_by_side.h"

namespace graphdrl {

// "1-8", "3", or several of both, as "1-4,9": ascending, each once. Throws Error, naming --seeds, on anything else.
std::vector<std::uint64_t> parse_seeds(const std::string& text);

// FOLDER/seeds.json: which seeds there are, and what their runs were told but for the seed. Throws Error.
struct SeedsFile {
  std::vector<std::uint64_t> seeds;  // ascending
  TrainOptions options;
};
SeedsFile read_seeds(const std::filesystem::path& folder);

class SeedRuns {
 public:
  // Plans a run for each seed: writes FOLDER/seeds.json. Goes on with the runs of a folder that were told the same.
  // Throws Error, as Trainer::start, and where the folder holds other runs. Collective: the first rank writes.
  static SeedRuns start(const TrainOptions& options, std::vector<std::uint64_t> seeds,
                        const std::filesystem::path& folder, const LearnerSource& learners = kCpuLearners,
                        Ranks& ranks = one_rank());

  // Goes on with the runs of a folder. Throws Error where its files are not whole.
  static SeedRuns resume(const std::filesystem::path& folder);

  // Whether a folder holds the runs of many seeds.
  static bool are_in(const std::filesystem::path& folder);

  static RunDirectory run_directory_in(const std::filesystem::path& folder, std::uint64_t seed);

  const std::filesystem::path& folder() const { return folder_; }
  SideBySide& trainings() { return trainings_; }  // in the order of the seeds

 private:
  SeedRuns(const SeedsFile& file, const std::filesystem::path& folder);

  std::filesystem::path folder_;
  SideBySide trainings_;
};

}  // namespace graphdrl
