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

// Grids are walked in directions, as in the paper, other worlds by neighbours.
inline ActionSpace action_space_of(const World& world) {
  return world.is_grid() ? ActionSpace::kDirections : ActionSpace::kNeighbours;
}

inline constexpr int kNoAction = -1;

// An answer of a policy that would rather end the episode than walk on.
inline constexpr int kStop = -1;

// What may be spent of a budget in all: sums of costs may be off by rounding.
inline double spending_limit(double budget) {
  return budget * (1 + 1e-9);
}

// A view into an episode, valid until its next step.
struct Observation {
  const World* world;
  ActionSpace action_space;
  NodeId position;
  std::span<const std::uint32_t> visits;  // [N]; the start counts, a blocked move counts for the node stayed on
  std::span<const NodeId> walk;           // every position so far, the start first; a blocked move repeats its node
  int visited_count;                      // valid nodes visited
  double budget_left;                     // in units of cost
  double spendable;                       // the same with room for the rounding of sums

  bool visited(NodeId node) const { return visits[node] > 0; }
  bool all_visited() const { return visited_count == world->valid_count(); }

  int action_count() const {
    return static_cast<int>(action_space == ActionSpace::kDirections ? kAllDirections.size()
                                                                     : world->open_neighbours(position).size());
  }

  // Where an action leads; the current node itself where the move is blocked.
  NodeId target(int action) const {
    return action_space == ActionSpace::kDirections ? world->direction_target(position, action)
                                                    : world->open_neighbours(position)[action];
  }

  // What an action costs. Directions are of grids, where every move costs 1, blocked or not.
  double cost(int action) const {
    return action_space == ActionSpace::kDirections ? 1.0 : world->open().cost(position, action);
  }

  // The action mask: false where a move would be blocked or costs more than is left. A blocked direction can be chosen
  // all the same; a move that cannot be paid for cannot.
  bool legal(int action) const { return target(action) != position && cost(action) <= spendable; }

  // The first action that leads to `next`; for the current node, the first blocked one. kNoAction where there is none.
  int action_to(NodeId next) const;
};

}  // namespace graphdrl
