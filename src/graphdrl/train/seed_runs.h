// Trainings of one configuration by many seeds, side by side. Each has a run directory of its own, FOLDER/seed-N, and
// ends with the bytes that it would have alone.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "graphdrl/train/trainer.h"

namespace graphdrl {

// "1-8", "3", or several of both, as "1-4,9": ascending, each once. Throws Error, naming --seeds, on anything else.
std::vector<std::uint64_t> parse_seeds(const std::string& text);

// FOLDER/seeds.json: which seeds there are, and what their runs were told but for the seed. Throws Error.
struct SeedsFile {
  std::vector<std::uint64_t> seeds;  // ascending
  TrainOptions options;
};
SeedsFile read_seeds(const std::filesystem::path& folder);

// Where all of them stand together.
struct SeedRunsNews {
  int seeds_done;
  std::int64_t units_done;  // episodes or rounds, of all seeds
  std::int64_t units;       // of all seeds
  double samples_per_s;     // in this session, over all seeds
};

class SeedRuns {
 public:
  // Begins a run for each seed: writes FOLDER/seeds.json, configurations and checkpoints 0. Throws Error, as
  // Trainer::start, and where the folder holds such runs already.
  static SeedRuns start(const TrainOptions& options, std::vector<std::uint64_t> seeds, std::filesystem::path folder,
                        const MakePaperLearner& make_learner = make_paper_cpu_learner);

  // Goes on with the runs of a folder. Throws Error where its files are not whole.
  static SeedRuns resume(std::filesystem::path folder, const MakePaperLearner& make_learner = make_paper_cpu_learner);

  // Whether a folder holds the runs of many seeds.
  static bool are_in(const std::filesystem::path& folder);

  // One seed a thread, on threads() threads, until all are trained or `stop` says so; then all are saved. Memory: that
  // of as many trainings as there are threads. `tell` may be called on any thread, but never twice at a time. Gives
  // whether all are trained.
  bool run(const std::function<bool()>& stop, const std::function<void(const SeedRunsNews&)>& tell);

  static RunDirectory run_directory_in(const std::filesystem::path& folder, std::uint64_t seed);

  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<std::uint64_t>& seeds() const { return seeds_; }
  RunDirectory run_directory(std::uint64_t seed) const { return run_directory_in(folder_, seed); }
  // Where a seed's training stood last.
  const TrainingProgress& progress(std::uint64_t seed) const;
  const Recipe::Units& units() const { return units_; }

 private:
  SeedRuns(TrainOptions options, std::vector<std::uint64_t> seeds, std::filesystem::path folder,
           MakePaperLearner make_learner)
      : options_(std::move(options)),
        seeds_(std::move(seeds)),
        folder_(std::move(folder)),
        make_learner_(std::move(make_learner)),
        progress_(seeds_.size()) {}

  // Begins the runs that are not there yet, and reads where the others stand.
  void begin();

  TrainOptions options_;  // but for the seed
  std::vector<std::uint64_t> seeds_;
  std::filesystem::path folder_;
  MakePaperLearner make_learner_;
  std::vector<TrainingProgress> progress_;  // of the seeds
  Recipe::Units units_;                     // of one seed
};

}  // namespace graphdrl
