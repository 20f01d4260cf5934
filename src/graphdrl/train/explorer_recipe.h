// The explorer's training: rounds of random walks, whose states search values, and of learning steps on what is
// remembered.
#pragma once

#include "graphdrl/base/random.h"
#include "graphdrl/train/explorer_learner.h"
#include "graphdrl/train/explorer_replay.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {

class ExplorerRecipe final : public Recipe {
 public:
  // `rng` must outlive it.
  ExplorerRecipe(const TrainOptions& options, Rng& rng);

  // One round, whole: draw() and learn().
  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) override;
  std::string status(const TrainingProgress& progress) const override;
  std::vector<Metric> take_metrics(const TrainingProgress& progress) override;
  void save(CheckpointWriter& checkpoint) const override;
  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override;
  void write_policy(const std::filesystem::path& path) const override;

  // The lessons of a round's walks, which the network leads as it is now. The same for any number of threads.
  std::vector<Lesson> draw(std::int64_t round) const;
  // Remembers a round's lessons, and takes its learning steps.
  void learn(std::int64_t round, std::vector<Lesson> lessons);

 private:
  TrainOptions options_;
  Rng& rng_;
  LessonOptions lesson_options_;
  ExplorerLearner learner_;
  ExplorerReplay replay_;
  // Of the last round.
  double loss_ = 0;
  double regret_ = 0;
};

}  // namespace graphdrl
