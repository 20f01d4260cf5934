// Trainings in rounds: walks are drawn, which give lessons; then come learning steps on all that is remembered.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "graphdrl/base/parallel.h"
#include "graphdrl/train/recipe.h"

namespace graphdrl {

class RoundRecipe : public Recipe {
 public:
  explicit RoundRecipe(const TrainOptions& options) : options_(options) {}

  bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) final;
  std::string status(const TrainingProgress& progress) const final;
  std::vector<Metric> take_metrics(const TrainingProgress& progress) final;

 protected:
  struct LearningStep {
    double loss;
    double regret;  // what is lost by the network's choices, in nodes
  };

  // Draws the lessons of a round, and remembers them; gives how many. Nothing where `stop` said so before the last.
  virtual std::optional<std::int64_t> draw(std::int64_t round, const std::function<bool()>& stop) = 0;
  // One learning step; nothing where there is nothing to learn from.
  virtual std::optional<LearningStep> learn(double rate) = 0;

  const TrainOptions& options() const { return options_; }

  // draw_walk(seed): the lessons of one walk. The same for any number of threads.
  template <typename Lesson, typename DrawWalk>
  std::optional<std::vector<Lesson>> draw_walks(std::int64_t round, const std::function<bool()>& stop,
                                                const DrawWalk& draw_walk) const {
    std::vector<std::vector<Lesson>> by_walk(static_cast<std::size_t>(options_.walks));
    std::atomic<bool> stopped = false;
    parallel_for(static_cast<int>(options_.walks), [&](int walk) {
      if (stopped || stop()) {
        stopped = true;
        return;
      }
      by_walk[walk] = draw_walk(seed_of(round, walk));
    });
    if (stopped) return std::nullopt;
    std::vector<Lesson> all;
    for (std::vector<Lesson>& of_walk : by_walk) {
      for (Lesson& lesson : of_walk) all.push_back(std::move(lesson));
    }
    return all;
  }

  // The round under way. Throws Error where another number of lessons is remembered than was drawn.
  void save_round(CheckpointWriter& checkpoint) const;
  void restore_round(const Checkpoint& checkpoint, std::int64_t remembered, const TrainingProgress& progress);

 private:
  std::uint64_t seed_of(std::int64_t round, int walk) const;
  bool take_steps(std::int64_t round, const std::function<bool()>& stop);

  TrainOptions options_;
  std::optional<std::int64_t> updates_;  // learning steps of the round under way; none before its walks are drawn
  // Of the round under way, or the last one.
  double loss_ = 0;
  double regret_ = 0;
};

}  // namespace graphdrl
