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
  // Reads where the runs stand that are begun, by their records. Throws Error where a directory holds a finished run of
  // other options; run() does so of the others.
  // REQUIRES: at least one run; all of one preset, length and device.
  explicit SideBySide(std::vector<PlannedRun> runs);

  // Begins the others and goes on with all, on threads() threads, until they are trained or `stop` says so; then those
  // that are begun are saved. Where the device works for several at once, runs that differ in their seeds alone are
  // trained together. Memory: that of the trainings under way. `tell` may be called on any thread, but never twice at a
  // time. Throws Error, as Trainer does, also RunLocked, once the other runs are trained. Gives whether all are
  // trained.
  bool run(const std::function<bool()>& stop, const std::function<void(const SideBySideNews&)>& tell,
           const LearnerSource& learners = kCpuLearners);

  const std::vector<PlannedRun>& runs() const { return runs_; }
  const std::vector<TrainingProgress>& progress() const { return progress_; }  // of the runs
  const TrainingUnits& units() const { return units_; }                        // of one run

 private:
  bool train(int run, const LearnerSource& learners, const std::function<bool()>& stop,
             const std::function<void(const TrainingProgress&)>& tell) const;
  std::int64_t sum(std::int64_t TrainingProgress::*member) const;

  std::vector<PlannedRun> runs_;
  std::vector<TrainingProgress> progress_;
  std::vector<char> finished_;  // by their records
  TrainingUnits units_;
};

}  // namespace graphdrl
