#include "graphdrl/planners/plan.h"

#include <algorithm>
#include <cmath>

#include "graphdrl/graph/search.h"

namespace graphdrl {

SearchStart search_start(const World& world, NodeId start, double budget) {
  SearchStart result{.world = &world, .position = start, .visited = {}, .budget_left = budget};
  result.visited.resize(world.graph().node_count());
  result.visited[start] = true;
  return result;
}

Deadline deadline_after(TimeLimit limit) {
  if (!limit) return std::nullopt;
  return std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(*limit);
}

int visited_after(const SearchStart& start, std::span<const NodeId> walk) {
  std::vector<bool> visited = start.visited;
  for (const NodeId node : walk) visited[node] = true;
  return static_cast<int>(std::count(visited.begin(), visited.end(), true));
}

std::vector<NodeId> walk_through(const SearchStart& start, std::span<const NodeId> first_visits) {
  std::vector<NodeId> walk = {start.position};
  std::vector<bool> visited = start.visited;
  for (const NodeId target : first_visits) {
    const std::vector<NodeId> path = path_to_nearest(
        start.world->open(), walk.back(), [&](NodeId node) { return node == target; },
        [&](NodeId node) { return visited[node] || node == target; });
    walk.insert(walk.end(), path.begin(), path.end());
    visited[target] = true;
  }
  return walk;
}

double walk_cost(const World& world, std::span<const NodeId> walk) {
  double cost = 0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const auto neighbours = world.open_neighbours(walk[i - 1]);
    const auto place = std::find(neighbours.begin(), neighbours.end(), walk[i]) - neighbours.begin();
    cost += place == std::ssize(neighbours) ? 1.0 : world.open().cost(walk[i - 1], static_cast<int>(place));
  }
  return cost;
}

int PlanPolicy::act_on(const Observation& observation) {
  const World& world = *observation.world;
  const auto steps = std::ssize(observation.walk) - 1;
  const NodeId start = observation.walk.front();
  const double budget = observation.budget_left + walk_cost(world, observation.walk);
  const auto [known, fresh] = plans_.try_emplace({&world, start});
  Remembered& remembered = known->second;
  if (fresh || std::abs(remembered.budget - budget) > 1e-6 * budget) {
    remembered = {budget, plan(search_start(world, start, budget)).walk};
  }
  const std::vector<NodeId>& walk = remembered.walk;
  const bool on_plan =
      steps < std::ssize(walk) && std::equal(observation.walk.begin(), observation.walk.end(), walk.begin());
  if (on_plan) return steps + 1 < std::ssize(walk) ? observation.action_to(walk[steps + 1]) : kStop;

  SearchStart here{.world = &world,
                   .position = observation.position,
                   .visited = {},
                   .budget_left = std::max(0.0, observation.budget_left)};
  for (const std::uint32_t visits : observation.visits) here.visited.push_back(visits > 0);
  const std::vector<NodeId> rest = plan(here).walk;
  return rest.size() < 2 ? kStop : observation.action_to(rest[1]);
}

}  // namespace graphdrl
