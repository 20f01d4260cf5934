#include "graphdrl/planners/baselines.h"

#include <algorithm>
#include <vector>

#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

// The action that leads to `next`; kStop where it cannot be paid for.
int step_to(const Observation& observation, NodeId next) {
  const int action = observation.action_to(next);
  return observation.cost(action) <= observation.spendable ? action : kStop;
}

}  // namespace

void SingleEpisodePolicy::act(std::span<const Observation> observations, std::span<int> actions) {
  for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = act_on(observations[i]);
}

int RandomPolicy::act_on(const Observation& observation) {
  const bool all = observation.action_space == ActionSpace::kDirections;  // blocked ones too
  std::vector<int> actions;
  for (int action = 0; action < observation.action_count(); ++action) {
    if (all || observation.legal(action)) actions.push_back(action);
  }
  return actions.empty() ? kStop : actions[rng_.below(static_cast<std::uint32_t>(actions.size()))];
}

int RandomWalkPolicy::act_on(const Observation& observation) {
  const World& world = *observation.world;
  std::vector<NodeId> neighbours;
  for (int i = 0; i < world.open().degree(observation.position); ++i) {
    if (world.open().cost(observation.position, i) > observation.spendable) continue;
    neighbours.push_back(world.open_neighbours(observation.position)[i]);
  }
  if (neighbours.empty()) return kStop;
  return observation.action_to(neighbours[rng_.below(static_cast<std::uint32_t>(neighbours.size()))]);
}

int DepthFirstPolicy::act_on(const Observation& observation) {
  const World& world = *observation.world;
  const auto fresh = [&](NodeId node) {
    const auto neighbours = world.open_neighbours(node);
    return std::find_if(neighbours.begin(), neighbours.end(),
                        [&](NodeId next) { return !observation.visited(next); }) != neighbours.end();
  };
  for (const NodeId next : world.open_neighbours(observation.position)) {
    if (!observation.visited(next)) return step_to(observation, next);
  }
  // The way from the root to here: a node entered for the first time goes on it, a step back takes one off.
  std::vector<NodeId> trail;
  std::vector<bool> seen(observation.visits.size());
  for (const NodeId node : observation.walk) {
    if (!seen[node]) {
      seen[node] = true;
      trail.push_back(node);
    } else if (!world.open().directed()) {
      trail.pop_back();
    }
  }
  if (!world.open().directed()) return trail.size() < 2 ? kStop : step_to(observation, trail[trail.size() - 2]);
  // One-way edges cannot be stepped back: the cheapest way to the node entered last from which something is left.
  const auto visited = [&](NodeId node) { return observation.visited(node); };
  for (; !trail.empty(); trail.pop_back()) {
    if (!fresh(trail.back())) continue;
    const auto path = path_to_nearest(
        world.open(), observation.position, [&](NodeId node) { return node == trail.back(); }, visited);
    if (!path.empty()) return step_to(observation, path.front());
  }
  return kStop;
}

int NearestUnvisitedPolicy::act_on(const Observation& observation) {
  const World& world = *observation.world;
  const std::vector<NodeId> path = path_to_nearest(
      world.open(), observation.position, [&](NodeId node) { return !observation.visited(node); },
      [](NodeId) { return true; });
  return path.empty() ? kStop : step_to(observation, path.front());
}

}  // namespace graphdrl
