// The training loop [paper, Algorithm 1].
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/report/event_writer.h"
#include "graphdrl/report/metrics_file.h"
#include "graphdrl/report/progress.h"
#include "graphdrl/train/learner.h"
#include "graphdrl/train/minibatch.h"
#include "graphdrl/train/replay_buffer.h"
#include "graphdrl/train/run_directory.h"
#include "graphdrl/train/train_options.h"

namespace graphdrl {

inline constexpr std::int64_t kLogEvery = 10;  // episodes: the paper's figure 2

// Where a training stands; every field goes into the checkpoint.
struct TrainingProgress {
  std::int64_t episode = 0;  // done
  std::int64_t steps = 0;    // of all episodes
  double elapsed_s = 0;      // of all sessions
  // Sums since the last line of metrics.
  std::int64_t window_episodes = 0;
  std::int64_t window_losses = 0;
  double window_loss = 0;
  double window_visited = 0;
  double window_coverage = 0;
  double window_reward = 0;
};

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

// One training in one run directory. Its whole state goes into each checkpoint, in the middle of an episode too, so
// that a resumed run ends with the bytes of one that was never interrupted.
class Trainer {
 public:
  // Begins a new run: writes the configuration and checkpoint 0. Throws Error on bad options and where the directory
  // cannot be written.
  static std::unique_ptr<Trainer> start(const TrainOptions& options, const RunDirectory& run);

  // Goes on with the run in a directory. Throws Error where its files are not whole.
  static std::unique_ptr<Trainer> resume(const RunDirectory& run);

  // Trains until the last episode is done or `stop`, asked before every step, says so; then saves. Gives whether the
  // training is finished.
  bool run(const std::function<bool()>& stop, ProgressDisplay& display);

  const TrainOptions& options() const { return options_; }
  const RunDirectory& run_directory() const { return run_; }
  const TrainingProgress& progress() const { return progress_; }

 private:
  Trainer(const TrainOptions& options, RunDirectory run, std::vector<World> worlds);  // touches no file

  void begin_episode();
  void begin_episode_at(int world, NodeId start);
  int choose_action();
  void remember(int action, const StepResult& step, NodeId from);
  void learn();
  void end_episode();
  MetricsLine window_means() const;
  void log(const MetricsLine& line, MetricsFile& metrics, EventWriter& events);
  void save();
  static std::vector<World> unpack_worlds(const Safetensors& file);
  void restore(const Safetensors& file);
  void restore_episode(const Safetensors& file);

  TrainOptions options_;
  RunDirectory run_;
  std::vector<World> worlds_;
  std::vector<PaperFeatureEncoder> encoders_;  // of the worlds
  std::vector<Episode> episodes_;              // one per world, reset again and again
  Rng rng_;
  std::unique_ptr<Learner> learner_;
  ReplayBuffer replay_;
  TrainingProgress progress_;

  // The episode under way.
  bool in_episode_ = false;
  int world_ = 0;
  std::vector<std::int32_t> actions_;  // so far
  double episode_reward_ = 0;

  std::vector<float> features_;               // of the current state, kept up to date: [N, F]
  std::vector<std::uint32_t> visits_before_;  // the step under way
  GraphBatch single_;
  Minibatch minibatch_;
};

}  // namespace graphdrl
