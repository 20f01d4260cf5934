// Experience replay [paper, section 2]: the last transitions, sampled uniformly.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "graphdrl/graph/graph.h"
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

}  // namespace graphdrl
