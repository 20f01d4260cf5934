// What is trained, and how: the part of a training that the presets do not share. The trainer asks for one unit (an
// episode, a round) after the other.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

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

class Recipe {
 public:
  virtual ~Recipe() = default;

  // Does one more unit, or the rest of one; adds its samples. `stop` may end it early: then it gives false, and the
  // next call goes on there.
  virtual bool run_unit(TrainingProgress& progress, const std::function<bool()>& stop) = 0;

  // After a unit, which is counted already: how it went, for a display …
  virtual std::string status(const TrainingProgress& progress) const = 0;
  // … and for the run's metrics; empty where none are due. Forgets what it gave.
  virtual std::vector<Metric> take_metrics(const TrainingProgress& progress) = 0;

  // Everything but the progress and the random numbers, which are the trainer's.
  virtual void save(CheckpointWriter& checkpoint) const = 0;
  virtual void restore(const Checkpoint& checkpoint, const TrainingProgress& progress) = 0;

  virtual void write_policy(const std::filesystem::path& path) const = 0;
};

// That of the preset explorer: a unit is a round of random walks, whose states search values, and of learning steps on
// what is remembered. `rng` must outlive it.
std::unique_ptr<Recipe> make_explorer_recipe(const TrainOptions& options, Rng& rng);

// The recipe of options.preset, at its beginning; `rng` must outlive it. `from`: the checkpoint to be restored, if any,
// which holds the maps. worlds: instead of options.maps, where there are any. Throws Error on maps that do not fit the
// options.
std::unique_ptr<Recipe> make_recipe(const TrainOptions& options, Rng& rng, const Checkpoint* from,
                                    const LearnerSource& learners, std::vector<World> worlds = {});

}  // namespace graphdrl
