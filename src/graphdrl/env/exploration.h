// An exploration under way, as searches and networks see it: what is visited, where it stands, what it may spend; and
// the moves it has, first visits.
#pragma once

#include "graphdrl/env/task.h"
#include "graphdrl/graph/node_set.h"

namespace graphdrl {

struct ExplorationState {
  NodeSetView visited;
  int visited_count;
  NodeId position;
  double spendable;                   // in units of cost
  const CostToEnd* to_end = nullptr;  // null where it may end anywhere

  double cost_to_end(NodeId node) const { return to_end == nullptr ? 0 : (*to_end)(node); }
  // What is left to spend beyond the way to the end.
  double free_to_spend() const { return spendable - cost_to_end(position); }
};

// A move: a walk to an unvisited node next to visited ground, by the cheapest way through visited ground.
struct FirstVisit {
  NodeId node;
  double cost;  // in units of cost
};

// What an unvisited node is likely to cost on top of one step, in mean edges, by its unvisited neighbours: one without
// any must be left again by the way one came; one with a single neighbour is a dead end. Of fourteen pairs of penalties
// tried, the one by which a beam visits most on random 11×11 mazes at 1.0x.
inline constexpr double kIsolatedPenalty = 4;
inline constexpr double kDeadEndPenalty = 2;

inline double leftover_penalty(int unvisited_neighbours) {
  return unvisited_neighbours == 0 ? kIsolatedPenalty : unvisited_neighbours == 1 ? kDeadEndPenalty : 0.0;
}

// By how much the sum of penalties over all unvisited nodes changes when `node` is visited: by -kIsolatedPenalty at
// least. Cost: O(degrees around it).
double change_of_penalties(const View& view, const NodeSetView& visited, NodeId node);

// How many unvisited neighbours a node has, as far as its penalty goes: more than two count as three.
inline int unvisited_neighbours_up_to_three(const View& view, const NodeSetView& visited, NodeId node) {
  int count = 0;
  for (const NodeId next : view.open_neighbours(node)) {
    count += !visited.contains(next);
    if (count > 2) break;
  }
  return count;
}

}  // namespace graphdrl
