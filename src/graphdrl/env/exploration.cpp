#include "graphdrl/env/exploration.h"

#include <algorithm>

namespace graphdrl {

int Exploration::new_count() const {
  if (!task_->claims_beyond_ground()) return view().valid_count() - ground_count_;
  return static_cast<int>(std::ranges::count_if(view().valid_nodes(), [&](NodeId node) { return is_new(node); }));
}

FirstVisit Exploration::nearest_first_visit(NearestFirst& search) const {
  FirstVisit nearest;
  for_first_visits(
      search,
      [&](NodeId node, double cost) {
        nearest = {node, cost};
        return false;
      },
      [](double) { return true; });
  return nearest;
}

void Exploration::make(const FirstVisit& visit, NodeSet& ground) {
  ground.insert(visit.node);
  ++ground_count_;
  position_ = visit.node;
  spendable_ -= visit.cost;
}

bool find_way(const Graph& open, NodeId from, NodeId goal, const NodeSetView& ground, NearestFirst& search) {
  using Next = NearestFirst::Next;
  bool found = false;
  search.run(open, from, kNoLimit, [&](NodeId node, double) {
    found = node == goal;
    if (found) return Next::kEnd;
    return ground.contains(node) ? Next::kThrough : Next::kPast;
  });
  return found;
}

double change_of_penalties(const View& view, const NodeSetView& ground, NodeId node) {
  double change = -leftover_penalty(unvisited_neighbours_up_to_three(view, ground, node));
  for (const NodeId other : view.into().neighbours(node)) {
    if (ground.contains(other)) continue;
    const int neighbours = unvisited_neighbours_up_to_three(view, ground, other);
    change += leftover_penalty(neighbours - 1) - leftover_penalty(neighbours);
  }
  return change;
}

}  // namespace graphdrl
