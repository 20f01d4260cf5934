// Independent trainings, one a thread. On the CPU each ends with the bytes that it would have alone, on another device
// with the same numbers within rounding.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "graphdrl/train/trainer.h"

namespace graphdrl {

// What a training is told, and where it goes.
struct PlannedRun {
  TrainOptions options;
  RunDirectory directory;
};

// Where several trainings stand together.
struct SideBySideNews {
  int runs_done;
  std::int64_t units_done;  // episodes or rounds, of all runs
  std::int64_t units;       // of all runs
  double samples_per_s;     // in this session, over all runs
};

class SideBySide {
 public:
  // Begins the runs that are not there yet, and reads where the others stand. Throws Error, as Trainer does, and where
  // a directory holds a run of other options. REQUIRES: at least one run; all of one preset, length and device.
  // make_group: for another device than the CPU. There runs that differ in their seeds alone are trained together, and
  // the others after them.
  SideBySide(std::vector<PlannedRun> runs, MakePaperLearner make_learner, MakePaperLearnerGroup make_group = {});

  // On threads() threads, until all are trained or `stop` says so; then all are saved. Memory: that of as many
  // trainings as there are threads; on another device, of those that are trained together. `tell` may be called on any
  // thread, but never twice at a time. Gives whether all are trained.
  bool run(const std::function<bool()>& stop, const std::function<void(const SideBySideNews&)>& tell);

  const std::vector<PlannedRun>& runs() const { return runs_; }
  const std::vector<TrainingProgress>& progress() const { return progress_; }  // of the runs
  const Recipe::Units& units() const { return units_; }                        // of one run

 private:
  using Train = std::function<void(int run, const MakePaperLearner&)>;
  void run_together(const std::vector<int>& runs, const Train& train) const;
  std::int64_t sum(std::int64_t TrainingProgress::*member) const;

  std::vector<PlannedRun> runs_;
  MakePaperLearner make_learner_;
  MakePaperLearnerGroup make_group_;
  std::vector<TrainingProgress> progress_;
  Recipe::Units units_;
};

}  // namespace graphdrl
