// The graph around an exploration's position: what the explorer's features are measured on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/env/exploration.h"

namespace graphdrl {

// How many nodes around the current one the features are measured on, whichever way edges lead. What lies beyond counts
// as one whole: unvisited nodes there as one part, joined to every part that touches them. 4096 takes a third more time
// in large worlds and visits no more (docs/explorer.md).
inline constexpr int kExplorerHorizon = 1024;

// The nodes within the horizon have local indices, by distance in steps from the current node, which is 0. Scratch
// memory of one thread: gathering costs what lies within, not the size of the world, but for growing to it once.
class Horizon {
 public:
  void gather(const Exploration& state);

  int size() const { return static_cast<int>(nodes_.size()); }
  NodeId node(int index) const { return nodes_[index]; }
  // -1 of a node beyond.
  int index_of(NodeId node) const { return marks_[node].call == call_ ? marks_[node].index : -1; }
  // Local indices, whichever way edges lead; neighbours beyond are left out.
  std::span<const int> neighbours(int index) const {
    return {neighbours_.data() + offsets_[index], neighbours_.data() + offsets_[index + 1]};
  }

  int degree(int index) const { return degree_[index]; }  // whichever way edges lead, to nodes beyond too
  bool is_unvisited(int index) const { return unvisited_[index] != 0; }
  int unvisited_neighbours(int index) const { return unvisited_neighbours_[index]; }  // beyond too
  int unvisited_count() const { return unvisited_count_; }                            // within

  bool is_all() const { return is_all_; }         // nothing that an edge leads to lies beyond
  int most_steps() const { return most_steps_; }  // from the current node to any within

 private:
  struct Mark {
    std::uint32_t call = 0;  // the call that set it
    int index = -1;
  };

  void gather_nodes(const Graph& graph, NodeId from);

  std::vector<Mark> marks_;  // [nodes of the largest world]
  std::uint32_t call_ = 0;

  // By local index:
  std::vector<NodeId> nodes_;
  std::vector<std::int64_t> offsets_;
  std::vector<int> neighbours_;
  std::vector<int> degree_;
  std::vector<std::uint8_t> unvisited_;
  std::vector<int> unvisited_neighbours_;

  int unvisited_count_ = 0;
  bool is_all_ = false;
  int most_steps_ = 0;
};

}  // namespace graphdrl
