// A map of four nodes and transitions on it, for tests of learners.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/paper_replay_buffer.h"
#include "support.h"

namespace graphdrl {

struct TinyWorld {
  World world = grid_world("..\n..\n");
  PaperFeatureEncoder encoder{world};
};

// Adds the transition of `action` after `actions` from node 0.
inline void add_transition(const TinyWorld& tiny, const std::vector<int>& actions, int action, PaperMinibatch& batch) {
  Episode episode(tiny.world, {.budget = 9, .end_at_full_coverage = true});
  episode.reset(0);
  for (const int past : actions) episode.step(past);
  const std::size_t row = batch.x.size();
  batch.graphs.add(tiny.world.graph());
  batch.x.resize(row + 4 * kPaperFeatureCount);
  batch.next_x.resize(row + 4 * kPaperFeatureCount);
  tiny.encoder.encode(episode.position(), std::span(episode.visits()), std::span(batch.x).subspan(row));
  const StepResult step = episode.step(action);
  tiny.encoder.encode(episode.position(), std::span(episode.visits()), std::span(batch.next_x).subspan(row));
  batch.actions.push_back(action);
  batch.rewards.push_back(static_cast<float>(step.reward));
  batch.terminal.push_back(episode.terminal());
}

}  // namespace graphdrl
