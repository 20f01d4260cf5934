// Trains the explorer: rounds of random walks, whose states search values, and of learning steps on what is remembered.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/report/progress.h"
#include "graphdrl/train/explorer_learner.h"
#include "graphdrl/train/explorer_options.h"
#include "graphdrl/train/run_directory.h"

namespace graphdrl {

struct ExplorerProgress {
  std::int64_t round = 0;   // done
  std::int64_t states = 0;  // drawn so far
  double elapsed_s = 0;     // of all sessions
};

// One training in one run directory. Its whole state goes into each checkpoint, between two rounds, so that a resumed
// run ends with the bytes of one that was never interrupted.
class ExplorerTrainer {
 public:
  // Begins a new run: writes the configuration and checkpoint 0. Throws Error on bad options and where the directory
  // cannot be written.
  static std::unique_ptr<ExplorerTrainer> start(const ExplorerOptions& options, const RunDirectory& run);

  // Goes on with the run in a directory. Throws Error where its files are not whole.
  static std::unique_ptr<ExplorerTrainer> resume(const RunDirectory& run);

  // Trains until the last round is done or `stop`, asked after every round, says so; then saves. Gives whether the
  // training is finished.
  bool run(const std::function<bool()>& stop, ProgressDisplay& display);

  const ExplorerOptions& options() const { return options_; }
  const RunDirectory& run_directory() const { return run_; }
  const ExplorerProgress& progress() const { return progress_; }

 private:
  ExplorerTrainer(const ExplorerOptions& options, RunDirectory run);  // touches no file

  void draw_lessons_of_round();
  void learn_round();
  void save();
  void restore(const Safetensors& file);

  ExplorerOptions options_;
  RunDirectory run_;
  LessonOptions lesson_options_;
  Rng rng_;
  ExplorerLearner learner_;
  std::vector<Lesson> memory_;  // a ring, once it is full
  ExplorerProgress progress_;
  double round_loss_ = 0;
  double round_regret_ = 0;
};

}  // namespace graphdrl
