// Independent trainings, one a thread. On the CPU each ends with the bytes that it would have alone, on another device
// with the same numbers within rounding.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "graphdrl/base/ranks.h"
#include "graphdrl/io/task_folder.h"
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
  // other options; run() does so of the others. The folder, that of all runs, remembers which failed.
  // REQUIRES: at least one run; all of one preset, length and device.
  SideBySide(std::vector<PlannedRun> runs, std::filesystem::path folder);

  // Begins the others and goes on with all that are of the share, on threads() threads of all ranks, until they are
  // trained or `stop` says so; then those that are begun are saved. Where the device works for several at once, runs
  // that differ in their seeds alone are trained together, by one rank. Memory: that of the trainings under way.
  // `tell`, of the runs of this rank, may be called on any thread, but never twice at a time. Throws Error, as Trainer
  // does, also RunLocked, once the other runs are trained [TaskFolder]. Gives whether all of the share are trained or
  // left out. Collective.
  bool run(const std::function<bool()>& stop, const std::function<void(const SideBySideNews&)>& tell,
           const LearnerSource& learners = kCpuLearners, const TaskWorkers& workers = {});

  // Whether a run failed too often. Asks the disk.
  bool is_left_out(std::size_t run) const { return folder_.is_left_out(name_of(run)); }
  bool is_trained(std::size_t run) const { return finished_[run] != 0; }

  const std::vector<PlannedRun>& runs() const { return runs_; }
  const std::vector<TrainingProgress>& progress() const { return progress_; }  // of the runs
  const TrainingUnits& units() const { return units_; }                        // of one run

 private:
  bool train(int run, const LearnerSource& learners, const std::function<bool()>& stop,
             const std::function<void(const TrainingProgress&)>& tell) const;
  std::string name_of(std::size_t run) const;
  void hear_of_others(Ranks& ranks);
  std::int64_t sum(std::int64_t TrainingProgress::*member) const;

  std::vector<PlannedRun> runs_;
  TaskFolder folder_;
  std::vector<TrainingProgress> progress_;
  std::vector<char> finished_;  // by their records
  TrainingUnits units_;
};

}  // namespace graphdrl
