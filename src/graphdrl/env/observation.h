// What a policy sees, and how it names its moves.
#pragma once

#include <cstdint>
#include <span>

#include "graphdrl/env/task.h"

namespace graphdrl {

enum class ActionSpace {
  kDirections,  // left, up, right, down on a grid; a blocked move costs a step and stays put
  kNeighbours,  // the a-th open neighbour of the current node; works on any graph
};

// Grids are walked in directions, as in the paper, other worlds by neighbours.
inline ActionSpace action_space_of(const View& view) {
  return view.is_grid() ? ActionSpace::kDirections : ActionSpace::kNeighbours;
}

inline constexpr int kNoAction = -1;  // no action leads there

// An answer of a policy that would rather end the episode than walk on.
inline constexpr int kStop = -2;

// A view into an episode, valid until its next step.
struct Observation {
  const Task* task;  // with what is known of the world
  ActionSpace action_space;
  NodeId position;
  std::span<const std::uint32_t> visits;  // [N]; the start counts, a blocked move counts for the node stayed on
  const NodeSet* ground_nodes;            // see ground()
  std::span<const NodeId> walk;           // every position so far, the start first; a blocked move repeats its node
  std::uint64_t walk_hash;                // of the walk: extended_walk_hash() of each position
  int visited_count;                      // valid nodes visited
  double spent;                           // in units of cost
  double spendable;                       // what is left, with room for the rounding of sums

  const View& view() const { return task->view(); }
  bool visited(NodeId node) const { return visits[node] > 0; }
  // What first visits walk through: the nodes visited; where what is seen counts, all but the frontier.
  const NodeSet& ground() const { return *ground_nodes; }
  bool all_visited() const { return visited_count == view().valid_count(); }

  int action_count() const {
    return action_space == ActionSpace::kDirections ? kDirectionCount : view().open().degree(position);
  }

  // Where an action leads; the current node itself where the move is blocked.
  NodeId target(int action) const {
    return action_space == ActionSpace::kDirections ? view().grid().direction_target(position, action)
                                                    : view().open_neighbours(position)[action];
  }

  // What an action costs. Directions are of grids, where every move costs 1, blocked or not.
  double cost(int action) const {
    return action_space == ActionSpace::kDirections ? 1.0 : view().open().cost(position, action);
  }

  // Whether what is left pays for the action, and for the way to the end after it.
  bool affordable(int action) const { return cost(action) + task->cost_to_end(target(action)) <= spendable; }

  // The action mask: false where a move would be blocked or cannot be paid for. A blocked direction can be chosen all
  // the same; a move that cannot be paid for cannot.
  bool legal(int action) const { return target(action) != position && affordable(action); }

  // The first action that leads to `next`; for the current node, the first blocked one. kNoAction where there is none.
  int action_to(NodeId next) const {
    if (action_space == ActionSpace::kNeighbours) return view().open().index_of(position, next);
    for (int action = 0; action < action_count(); ++action) {
      if (target(action) == next) return action;
    }
    return kNoAction;
  }
};

// A number of 64 bits for a walk, kept up to date step by step: equal walks have equal ones, and others do not but by
// a chance of 1 in 2^64.
inline constexpr std::uint64_t kEmptyWalkHash = 0xcbf29ce484222325ULL;
inline std::uint64_t extended_walk_hash(std::uint64_t hash, NodeId next) {
  hash = (hash ^ static_cast<std::uint32_t>(next)) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 29);
}

}  // namespace graphdrl
