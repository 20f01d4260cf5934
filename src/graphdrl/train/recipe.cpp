#include "graphdrl/train/recipe.h"

#include "graphdrl/env/load_worlds.h"
#include "graphdrl/train/explorer_recipe.h"
#include "graphdrl/train/paper_recipe.h"

namespace graphdrl {

std::unique_ptr<Recipe> make_recipe(const TrainOptions& options, Rng& rng, const Checkpoint* from,
                                    const MakePaperLearner& make_learner, std::vector<World> worlds) {
  if (options.preset == kExplorerPreset) return std::make_unique<ExplorerRecipe>(options, rng);
  if (from != nullptr) {
    worlds = worlds_of(*from);
  } else if (worlds.empty()) {
    worlds = load_worlds(options.maps);
  }
  return std::make_unique<PaperRecipe>(options, rng, std::move(worlds), make_learner);
}

}  // namespace graphdrl
