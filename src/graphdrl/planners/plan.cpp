#include "graphdrl/planners/plan.h"

#include <algorithm>
#include <utility>

namespace graphdrl {

void Plan::settle(double other_bound) {
  bound = std::min(bound, other_bound);
  optimal = optimal || meets(prize, bound);
  if (optimal) bound = prize;
}

bool better(const Plan& one, const Plan& other) {
  return one.prize != other.prize ? one.prize > other.prize : one.cost < other.cost;
}

Plan better_of(Plan first, Plan second) {
  const bool take_second = better(second, first) || (second.optimal && !better(first, second));
  return take_second ? std::move(second) : std::move(first);
}

Plan plan_of_walk(const Task& task, std::vector<NodeId> walk, bool optimal) {
  Plan plan{.walk = std::move(walk), .optimal = optimal};
  const Graph& open = task.view().open();
  NodeSet visited = task.ground();
  plan.visited = visited.count();
  plan.prize = task.prize(task.start());
  for (std::size_t i = 1; i < plan.walk.size(); ++i) {
    const NodeId next = plan.walk[i];
    const NodeId from = plan.walk[i - 1];
    plan.cost += next == from ? 1.0 : open.cost(from, open.index_of(from, next));
    if (visited.contains(next)) continue;
    visited.insert(next);
    ++plan.visited;
    plan.prize += task.prize(next);
  }
  return plan;
}

bool can_walk(const Task& task, std::span<const NodeId> walk) {
  const Graph& open = task.view().open();
  double cost = 0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const int place = open.index_of(walk[i - 1], walk[i]);
    if (place < 0) return false;
    cost += open.cost(walk[i - 1], place);
  }
  return cost <= task.limit() && (task.ends_anywhere() || walk.back() == task.end());
}

Plan Planner::plan_from(const Task& task, Plan known, const Clock& clock) {
  return better_of(std::move(known), plan(task, clock));
}

std::vector<NodeId> walk_through(const Task& task, std::span<const NodeId> first_visits, NearestFirst& search) {
  std::vector<NodeId> walk = {task.start()};
  NodeSet visited = task.ground();
  for (const NodeId target : first_visits) {
    find_way(task.view().open(), walk.back(), target, visited, search);
    search.append_path_to(target, walk);
    visited.insert(target);
  }
  append_way_to_end(task, walk, search);
  return walk;
}

void append_way_to(const View& view, NodeId node, std::vector<NodeId>& walk, NearestFirst& search) {
  if (walk.back() == node) return;
  search.run(view.open(), walk.back(), kNoLimit,
             [&](NodeId met, double) { return met == node ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough; });
  search.append_path_to(node, walk);
}

void append_way_to_end(const Task& task, std::vector<NodeId>& walk, NearestFirst& search) {
  if (task.ends_anywhere() || walk.back() == task.end()) return;
  search.run_cheapest(task.view().open(), walk.back(), kNoLimit, [&](NodeId met, double) {
    return met == task.end() ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
  });
  search.append_path_to(task.end(), walk);
}

}  // namespace graphdrl
