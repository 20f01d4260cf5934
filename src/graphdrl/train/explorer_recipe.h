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

  Units units() const override { return {.name = "round", .count = options_.rounds, .samples = "states"}; }
  // One round, whole.
  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) override;
  std::string status(const TrainingProgress& progress) const override;
  std::vector<Metric> take_metrics(const TrainingProgress& progress) override;
  void save(CheckpointWriter& checkpoint) const override;
  void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) override;
  void write_policy(const std::filesystem::path& path) const override;

 private:
  void draw_lessons_of_round(TrainingProgress& progress);
  void learn_round(std::int64_t round);

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
