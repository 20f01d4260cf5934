#include "graphdrl/planners/tour.h"

namespace graphdrl {

Tour tour_of(const Task& task, const Targets& targets, const Plan& plan) {
  const std::vector<NodeId>& walk = plan.walk;
  Tour tour{.order = {}, .links = {}, .prize = plan.prize, .cost = plan.cost};
  const Graph& open = task.view().open();
  std::vector<char> taken(targets.end());
  double cost = 0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    if (walk[i] == walk[i - 1]) continue;  // a blocked move
    cost += open.cost(walk[i - 1], open.index_of(walk[i - 1], walk[i]));
    const int target = targets.target_of(walk[i]);
    if (target <= 0 || taken[target] != 0) continue;
    taken[target] = 1;
    tour.order.push_back(target);
    tour.links.push_back(cost);
    cost = 0;
  }
  tour.links.push_back(task.ends_anywhere() ? 0 : cost);
  return tour;
}

std::vector<NodeId> walk_of(const Task& task, const Targets& targets, std::span<const int> order) {
  NearestFirst search;
  std::vector<NodeId> walk = {task.start()};
  for (const int target : order) append_way_to(task.view(), targets.node(target), walk, search);
  append_way_to_end(task, walk, search);
  return walk;
}

}  // namespace graphdrl
