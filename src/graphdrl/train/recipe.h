// What is trained, and how: the part of a training that the presets do not share. The trainer asks for one unit (an
// episode, a round) after the other.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/base/ranks.h"
#include "graphdrl/env/world.h"
#include "graphdrl/train/checkpoint.h"
#include "graphdrl/train/options.h"
#include "graphdrl/train/paper_learner.h"

namespace graphdrl {

struct Metric {
  std::string name;
  double value;       // not a number where there is none yet
  bool curve = true;  // for TensorBoard too
};

// What TrainingProgress counts.
struct TrainingUnits {
  std::string name;     // "episode"
  std::int64_t count;   // of the whole training
  std::string samples;  // "steps"
};
TrainingUnits units_of(const TrainOptions& options);

// A loss or a weight that is no finite number: what() says which of both, and when.
class NotFinite : public Error {
 public:
  using Error::Error;
};

class Recipe {
 public:
  virtual ~Recipe() = default;

  // Does one more unit, or the rest of one; adds its samples. `stop` may end it early: then it gives false, and the
  // next call goes on there. Throws NotFinite of a loss. Collective: a stop on one rank stops all.
  virtual bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) = 0;

  // After a unit, which is counted already: how it went, for a display …
  virtual std::string status(const TrainingProgress& progress) const = 0;
  // … and for the run's metrics; empty where none are due. Forgets what it gave.
  virtual std::vector<Metric> take_metrics(const TrainingProgress& progress) = 0;

  // The name of the first tensor with a weight that is not finite; empty where there is none.
  virtual std::string not_finite() const = 0;

  // Everything but the progress and the random numbers, which are the trainer's.
  virtual void save(CheckpointWriter& checkpoint) const = 0;
  virtual void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) = 0;

  virtual void write_policy(const std::filesystem::path& path) const = 0;
};

// The recipe of options.preset, at its beginning; `rng` must outlive it. `from`: the checkpoint to be restored, if any,
// which holds the maps. worlds: instead of options.maps, where there are any. Throws Error on maps that do not fit the
// options. ranks: work on it together; of the preset paper there must be one.
std::unique_ptr<Recipe> make_recipe(const TrainOptions& options, Rng& rng, const Checkpoint* from,
                                    const LearnerSource& learners, std::vector<World> worlds, Ranks& ranks);

// That of the preset explorer (explorer_recipe.cpp). A unit is a round of random walks, whose states search values, and
// of learning steps on what is remembered. `stop` is asked before every walk and every learning step; a round whose
// walks are not all drawn begins anew.
std::unique_ptr<Recipe> make_explorer_recipe(const TrainOptions& options, Rng& rng, Ranks& ranks);
// Of maps that are not known.
std::unique_ptr<Recipe> make_online_recipe(const TrainOptions& options, Rng& rng, Ranks& ranks);

// That of the preset paper (paper_recipe.cpp): Deep Q-learning over episodes on grid maps [paper, Algorithm 1]. A unit
// is an episode; `stop` is asked before every step. Metrics are means over ten episodes, or fewer at the end; epsilon
// is the last one's.
std::unique_ptr<Recipe> make_paper_recipe(const TrainOptions& options, Rng& rng, std::vector<World> worlds,
                                          const LearnerSource& learners);

// How much its policy explores: exp(-x), x evenly spaced from 0.1 in the first episode to 3 in the last, as the paper's
// author's code has it; one single episode has 0.1. REQUIRES: 0 <= episode < episodes.
double paper_epsilon(std::int64_t episode, std::int64_t episodes);

// The maps that its checkpoint holds: a run goes on from anywhere, whatever became of the map files. Throws Error where
// it holds none.
std::vector<World> worlds_of(const Checkpoint& checkpoint);

}  // namespace graphdrl
