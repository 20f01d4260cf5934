// Samples of the replay buffer, as the learner takes them, and the dropout of a learning step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/world.h"
#include "graphdrl/nn/graph_batch.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/paper_replay_buffer.h"

namespace graphdrl {

// B transitions, encoded. s and s' of a transition lie in the same graph.
struct PaperMinibatch {
  GraphBatch graphs;
  std::vector<float> x;                // s:  [N, F]
  std::vector<float> next_x;           // s': [N, F]
  std::vector<std::int64_t> actions;   // [B]
  std::vector<float> rewards;          // [B]
  std::vector<std::uint8_t> terminal;  // [B], 0 or 1

  std::vector<std::uint16_t> next_visits;  // room to build s'

  void clear();
};

// Adds one transition, encoded; `encoder` is that of its world.
void append_transition(const PaperReplayBuffer& replay, std::size_t index, const PaperFeatureEncoder& encoder,
                       PaperMinibatch& batch);

// Draws `size` transitions uniformly, with replacement, and builds their features. `encoders` are those of the worlds
// that the transitions name. The batch's memory is used again.
void sample_minibatch(const PaperReplayBuffer& replay, std::span<const PaperFeatureEncoder> encoders, std::int64_t size,
                      Rng& rng, PaperMinibatch& batch);

// 0 with probability p, else 1 / (1 - p); [rows, width].
std::vector<float> draw_keep_scale(int rows, int width, double p, Rng& rng);

}  // namespace graphdrl
