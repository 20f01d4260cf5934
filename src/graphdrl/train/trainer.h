// The one training loop: units of a recipe, their metrics, checkpoints; stopping and going on.
#pragma once

#include <functional>
#include <memory>

#include "graphdrl/base/random.h"
#include "graphdrl/report/event_writer.h"
#include "graphdrl/report/metrics_file.h"
#include "graphdrl/train/options.h"
#include "graphdrl/train/recipe.h"
#include "graphdrl/train/run_directory.h"
#include "graphdrl/train/run_lock.h"

namespace graphdrl {

// Said after every unit.
struct TrainingNews {
  const TrainingProgress& progress;
  std::string status;                  // how it goes, for a display
  const std::vector<Metric>& metrics;  // of the run's metrics, where some are due; else empty
};

// One training in one run directory, which it keeps locked. Its whole state goes into each checkpoint, in the middle of
// an episode too, so that a resumed run ends with the bytes of one that was never interrupted.
class Trainer {
 public:
  // Throws Error on what start() would refuse before it writes anything.
  static void check(const TrainOptions& options, const LearnerSource& learners);

  // Begins a new run: writes the configuration and checkpoint 0. Throws Error on bad options and where the directory
  // holds a run or cannot be written, RunLocked where another trainer is at work on it. worlds: instead of
  // options.maps, where there are any.
  static std::unique_ptr<Trainer> start(const TrainOptions& options, const RunDirectory& run,
                                        const LearnerSource& learners = kCpuLearners, std::vector<World> worlds = {},
                                        Ranks& ranks = one_rank());
  // `learners` and `ranks` must outlive the trainer. Several ranks train together (not the preset paper), and the first
  // one writes: all calls are collective then, and all ranks must see the run directory.

  // What a run was told, by its checkpoint or else by its configuration; the defaults where it has neither.
  static TrainOptions options_of(const RunDirectory& run);

  // Goes on with the run in a directory, from its checkpoint; from the one before it where that is missing or damaged;
  // from the beginning where the run has no checkpoint yet. Everything else is mended from the checkpoint, with a note.
  // Throws Error where no checkpoint is whole, and as start().
  static std::unique_ptr<Trainer> resume(const RunDirectory& run, const LearnerSource& learners = kCpuLearners,
                                         Ranks& ranks = one_rank());

  Trainer(const Trainer&) = delete;

  // Trains until the last unit is done or `stop`, asked after every unit and maybe within it, on any thread, says so;
  // then saves. Gives whether the training is finished. Throws MachineError, which says what is saved, where the disk
  // or the memory is not enough.
  bool run(const std::function<bool()>& stop, const std::function<void(const TrainingNews&)>& tell);

  const TrainOptions& options() const { return options_; }  // of the checkpoint, where the run was resumed
  const RunDirectory& run_directory() const { return run_; }
  const TrainingProgress& progress() const { return progress_; }
  const TrainingUnits& units() const { return units_; }

 private:
  // Touches no file.
  Trainer(const TrainOptions& options, RunDirectory run, const Checkpoint* from, const LearnerSource& learners,
          std::vector<World> worlds, Ranks& ranks);

  bool finished() const { return progress_.done == units_.count; }
  void mend(const RunState& state, const Checkpoint& from);
  void restore(const Checkpoint& from);
  void go_back(const NotFinite& failure);
  bool train(const std::function<bool()>& stop, const std::function<void(const TrainingNews&)>& tell);
  // Gives what was written.
  std::vector<Metric> log();
  void require_finite() const;
  void save();
  void write_files();

  TrainOptions options_;
  RunDirectory run_;
  const LearnerSource& learners_;
  Ranks& ranks_;
  std::unique_ptr<RunLock> lock_;  // as all that is written, the first rank's
  Rng rng_;
  std::unique_ptr<Recipe> recipe_;
  TrainingUnits units_;
  TrainingProgress progress_;
  std::int64_t rollbacks_ = 0;                 // each of which has halved the learning rate
  std::string metrics_;                        // the lines of earlier sessions
  std::unique_ptr<MetricsFile> metrics_file_;  // of this session
  std::unique_ptr<EventWriter> events_;
  TrainingProgress saved_;
  bool keeps_checkpoint_ = false;  // the one on the disk is whole, and becomes the one before the next
  bool is_whole_ = false;          // finished, and every file as it should be
};

}  // namespace graphdrl
