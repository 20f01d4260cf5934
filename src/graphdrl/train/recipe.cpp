#include "graphdrl/train/recipe.h"

#include "graphdrl/env/load_worlds.h"

namespace graphdrl {

TrainingUnits units_of(const TrainOptions& options) {
  if (options.preset == kExplorerPreset) return {.name = "round", .count = options.rounds, .samples = "states"};
  return {.name = "episode", .count = options.episodes, .samples = "steps"};
}

std::unique_ptr<Recipe> make_recipe(const TrainOptions& options, Rng& rng, const Checkpoint* from,
                                    const LearnerSource& learners, std::vector<World> worlds, Ranks& ranks) {
  if (options.preset == kExplorerPreset) {
    return options.reveal == "all" ? make_explorer_recipe(options, rng, ranks)
                                   : make_online_recipe(options, rng, ranks);
  }
  if (from != nullptr) worlds = worlds_of(*from);
  if (worlds.empty()) worlds = load_worlds(options.maps);
  return make_paper_recipe(options, rng, std::move(worlds), learners);
}

}  // namespace graphdrl
