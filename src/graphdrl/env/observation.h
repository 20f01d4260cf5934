// What a policy sees, and how it names its moves.
#pragma once

#include <cstdint>
#include <span>

#include "graphdrl/env/world.h"

namespace graphdrl {

enum class ActionSpace {
  kDirections,  // left, up, right, down on a grid; a blocked move costs a step and stays put
  kNeighbours,  // the a-th open neighbour of the current node; works on any graph
};

// An answer of a policy that would rather end the episode than walk on.
inline constexpr int kStop = -1;

// A view into an episode, valid until its next step.
struct Observation {
  const World* world;
  ActionSpace action_space;
  NodeId position;
  std::span<const std::uint32_t> visits;  // [N]; the start counts, a blocked move counts for the node stayed on
  std::span<const NodeId> walk;           // every position so far, the start first; a blocked move repeats its node
  int visited_count;                      // valid nodes visited
  double budget_left;                     // in steps

  bool visited(NodeId node) const { return visits[node] > 0; }
  bool all_visited() const { return visited_count == world->valid_count(); }
  int action_count() const {
    return action_space == ActionSpace::kDirections ? 4 : static_cast<int>(world->open_neighbours(position).size());
  }
};

// The action that walks from the current node to `next`. REQUIRES: `next` is an open neighbour of it.
int action_to(const Observation& observation, NodeId next);

}  // namespace graphdrl
