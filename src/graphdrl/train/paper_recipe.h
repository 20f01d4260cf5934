// The paper's training: Deep Q-learning over episodes on grid maps [paper, Algorithm 1].
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "graphdrl/train/recipe.h"

namespace graphdrl {

// How much an epsilon-greedy policy explores: exp(-x), x evenly spaced from 0.1 in the first episode to 3 in the last,
// as the paper's author's code has it; one single episode has 0.1. REQUIRES: 0 <= episode < episodes.
double paper_epsilon(std::int64_t episode, std::int64_t episodes);

// A unit is an episode; `stop` is asked before every step. Metrics are means over ten episodes, or fewer at the end;
// epsilon is the last one's. Throws Error on maps that do not fit the options. `rng` must outlive it.
std::unique_ptr<Recipe> make_paper_recipe(const TrainOptions& options, Rng& rng, std::vector<World> worlds,
                                          const LearnerSource& learners);

// The maps that a checkpoint of this recipe holds: a run goes on from anywhere, whatever became of the map files.
std::vector<World> worlds_of(const Checkpoint& checkpoint);

}  // namespace graphdrl
