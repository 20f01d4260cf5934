// The visited sets of a beam's partial walks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/graph/node_set.h"
#include "graphdrl/planners/best_states.h"

namespace graphdrl {

// Partial walks of a level differ in few nodes, however many all of them have visited: one set is common to all, and
// each walk has a row of bits for the nodes that some of them visited and others did not. So a level costs what its
// walks differ in, not the size of the world.
class VisitedSets {
 public:
  // One walk, which has visited `start`.
  VisitedSets(NodeSet start, NodeId node_count) : common_(std::move(start)), place_(node_count, kNoPlace) {}

  // Replaces the level by the next one, of which each walk is one of this level with one more node.
  // REQUIRES: there is a child; no parent has visited its child's node.
  void advance(std::span<const Candidate> children);

  NodeSetView operator[](int walk) const { return {common_, place_.data(), rows_.data() + walk * words_}; }

 private:
  static constexpr std::int32_t kNoPlace = -1;

  void give_place(NodeId node);
  void settle_what_all_agree_on(std::size_t walks);

  NodeSet common_;
  std::vector<std::int32_t> place_;  // [N], in rows; kNoPlace where `common_` holds for all walks
  std::vector<NodeId> node_at_;      // by place; kNoNode where it is free
  std::vector<std::int32_t> free_;   // places
  std::size_t words_ = 0;            // of a row
  std::vector<std::uint64_t> rows_;  // [walks, words_]
  std::vector<std::uint64_t> next_;  // likewise, of the next level
  int levels_ = 0;
};

}  // namespace graphdrl
