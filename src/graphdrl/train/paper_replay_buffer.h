// Experience replay [paper, section 2]: the last transitions, sampled uniformly, and the minibatches made of them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/nn/graph_batch.h"
#include "graphdrl/nn/paper_features.h"
#include "graphdrl/train/checkpoint.h"

namespace graphdrl {

// (s, a, r, s') without the visit counts, which stand beside it in the buffer. s' has one visit more, at next_position.
struct Transition {
  std::int32_t world;
  NodeId position;
  std::int32_t action;
  NodeId next_position;
  float reward;
  bool terminal;  // nothing follows s': no bootstrap
};

inline constexpr int kMaxReplayBudget = 65'534;  // steps; visit counts are kept in 16 bits

// A ring of compact states: features are built when sampled. Memory grows with what is stored, up to the capacity.
class PaperReplayBuffer {
 public:
  // max_nodes: of the largest world. REQUIRES: capacity >= 1.
  PaperReplayBuffer(std::size_t capacity, std::size_t max_nodes) : capacity_(capacity), max_nodes_(max_nodes) {}

  // visits: of s, [N]. REQUIRES: N <= max_nodes.
  void push(const Transition& transition, std::span<const std::uint32_t> visits);

  std::size_t size() const { return transitions_.size(); }
  const Transition& transition(std::size_t index) const { return transitions_[index]; }
  std::span<const std::uint16_t> visits(std::size_t index) const {  // of s, [max_nodes], zeros at the end
    return std::span(visits_).subspan(index * max_nodes_, max_nodes_);
  }

  // For checkpoints: arrays named replay.*. The visits stay this object's until they are written.
  void save(CheckpointWriter& checkpoint) const;
  // Throws Error where the arrays do not fit this buffer, or hold a transition that is_valid refuses.
  void restore(const Checkpoint& checkpoint, const std::function<bool(const Transition&)>& is_valid);

 private:
  static constexpr std::int64_t kIntegers = 5;  // of a transition: world, position, action, next_position, terminal

  std::size_t capacity_;
  std::size_t max_nodes_;
  std::size_t next_ = 0;  // where the next transition goes once the buffer is full
  std::vector<Transition> transitions_;
  std::vector<std::uint16_t> visits_;  // [size, max_nodes]
};

// B transitions, encoded. s and s' of a transition lie in the same graph.
struct PaperMinibatch {
  GraphBatch graphs;
  std::vector<float> x;                // s:  [N, F]
  std::vector<float> next_x;           // s': [N, F]
  std::vector<std::int64_t> actions;   // [B]
  std::vector<float> rewards;          // [B]
  std::vector<std::uint8_t> terminal;  // [B], 0 or 1

  std::vector<std::uint16_t> next_visits;  // room to build s'

  void clear() {
    graphs.clear();
    for (auto* values : {&x, &next_x, &rewards}) values->clear();
    actions.clear();
    terminal.clear();
  }
};

// Adds one transition, encoded; `encoder` is that of its world.
void append_transition(const PaperReplayBuffer& replay, std::size_t index, const PaperFeatureEncoder& encoder,
                       PaperMinibatch& batch);

// Draws `size` transitions uniformly, with replacement, and builds their features. `encoders` are those of the worlds
// that the transitions name. The batch's memory is used again.
void sample_minibatch(const PaperReplayBuffer& replay, std::span<const PaperFeatureEncoder> encoders, std::int64_t size,
                      Rng& rng, PaperMinibatch& batch);

}  // namespace graphdrl
