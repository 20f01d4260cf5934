// The paper's training: Deep Q-learning over episodes on grid maps [paper, Algorithm 1].
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/paper_learner.h"
#include "graphdrl/train/paper_minibatch.h"
#include "graphdrl/train/paper_replay_buffer.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {

inline constexpr std::int64_t kLogEvery = 10;  // episodes: the paper's figure 2

class PaperRecipe final : public Recipe {
 public:
  // Throws Error on maps that do not fit the options. `rng` must outlive it.
  PaperRecipe(const TrainOptions& options, Rng& rng, std::vector<World> worlds, const LearnerSource& learners);

  // One episode, or the rest of one. Asks `stop` before every step.
  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) override;
  std::string status(const TrainingProgress& progress) const override;
  // Means over ten episodes, or fewer at the end; epsilon is the last one's.
  std::vector<Metric> take_metrics(const TrainingProgress& progress) override;
  void save(CheckpointWriter& checkpoint) const override;
  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override;
  void write_policy(const std::filesystem::path& path) const override;

 private:
  // Sums over the episodes since the last line of metrics.
  struct Window {
    std::int64_t episodes = 0;
    std::int64_t losses = 0;
    double loss = 0;
    double visited = 0;
    double coverage = 0;  // percent
    double reward = 0;

    double mean_loss() const;  // not a number before learning starts
    double mean(double sum) const { return sum / static_cast<double>(episodes); }
  };
  template <typename AnyWindow, typename Field>
  static void for_each_window_field(AnyWindow& window, const Field& field);

  void begin_episode();
  void begin_episode_at(int world, NodeId start);
  int choose_action(std::int64_t episode);
  void remember(int action, const StepResult& step, NodeId from);
  void learn();
  void take_losses(std::int64_t last_step);
  void end_episode();
  void restore_episode(const Checkpoint& checkpoint);

  TrainOptions options_;
  Rng& rng_;
  std::vector<World> worlds_;
  std::vector<PaperFeatureEncoder> encoders_;  // of the worlds
  std::vector<Episode> episodes_;              // one per world, reset again and again
  std::unique_ptr<PaperLearner> learner_;
  PaperReplayBuffer replay_;
  Window window_;

  // The episode under way.
  bool in_episode_ = false;
  int world_ = 0;
  std::vector<std::int32_t> actions_;  // so far
  double episode_reward_ = 0;

  std::vector<float> features_;               // of the current state, kept up to date: [N, F]
  std::vector<std::uint32_t> visits_before_;  // the step under way
  GraphBatch single_;
  PaperMinibatch minibatch_;
};

// The maps that a checkpoint of this recipe holds: a run goes on from anywhere, whatever became of the map files.
std::vector<World> worlds_of(const Checkpoint& checkpoint);

}  // namespace graphdrl
