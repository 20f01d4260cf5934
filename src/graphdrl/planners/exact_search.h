// What the two exact searches share: a world small enough for sets of nodes to be words, and their states.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graphdrl/planners/exact.h"

namespace graphdrl {

using NodeMask = std::uint64_t;  // of nodes in reach, by local index

constexpr NodeMask bit(int node) {
  return NodeMask{1} << node;
}

struct ExactState {
  NodeMask visited;
  int position;
  friend bool operator==(const ExactState&, const ExactState&) = default;
};

struct ExactStateHash {
  std::size_t operator()(const ExactState& state) const {
    std::uint64_t h = (state.visited ^ (static_cast<std::uint64_t>(state.position) << 58)) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return h ^ (h >> 32);
  }
};

// The part of a world that a task can reach, its nodes numbered in ascending order of id.
struct SmallWorld {
  explicit SmallWorld(const Task& task);
  bool fits() const { return !neighbours.empty(); }

  std::vector<NodeId> nodes;               // by local index; only some of them if too many
  std::vector<NodeMask> neighbours;        // by local index; empty if too many
  std::vector<std::vector<double>> costs;  // [from][to], meaningful along edges
  std::vector<double> prizes;              // of first visits
  std::vector<double> cost_to_end;         // by any way; 0 where the walk may end anywhere
  ExactState state{};                      // at the start
  int end = -1;                            // -1 for anywhere
};

// For tasks where every edge costs 1, every prize is 1 and the walk may end anywhere. States are expanded in order of
// waste. From all starts of the paper's ten maps this takes 0.1 s, the general search 13 s; on twenty 5x5 grids with
// obstacles at 1.0x 0.3 s and 11 s (one thread). Empty if out of reach, or once the clock passes.
std::optional<int> plain_exact_gain(const Task& task);  // nodes first visited
std::optional<std::vector<NodeId>> plain_exact_walk(const Task& task, const Clock& clock);

// For any task. States are expanded in order of an upper bound of their worth: what was visited, and as much of the
// rest as its cheapest arrivals allow. Empty if out of reach, or once the clock passes.
std::optional<std::vector<NodeId>> general_exact_walk(const Task& task, const Clock& clock);

}  // namespace graphdrl
