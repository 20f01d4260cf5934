#include "graphdrl/env/exploration.h"

namespace graphdrl {

double change_of_penalties(const View& view, const NodeSetView& visited, NodeId node) {
  double change = -leftover_penalty(unvisited_neighbours_up_to_three(view, visited, node));
  for (const NodeId other : view.into().neighbours(node)) {
    if (visited.contains(other)) continue;
    const int neighbours = unvisited_neighbours_up_to_three(view, visited, other);
    change += leftover_penalty(neighbours - 1) - leftover_penalty(neighbours);
  }
  return change;
}

}  // namespace graphdrl
