#include "graphdrl/planners/baselines.h"

#include <algorithm>
#include <vector>

#include "graphdrl/graph/search.h"

namespace graphdrl {

void SingleEpisodePolicy::act(std::span<const Observation> observations, std::span<int> actions) {
  for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = act_on(observations[i]);
}

int RandomPolicy::act_on(const Observation& observation) {
  const int actions = observation.action_count();
  return actions == 0 ? kStop : static_cast<int>(rng_.below(static_cast<std::uint32_t>(actions)));
}

int RandomWalkPolicy::act_on(const Observation& observation) {
  const auto neighbours = observation.world->open_neighbours(observation.position);
  if (neighbours.empty()) return kStop;
  return observation.action_to(neighbours[rng_.below(static_cast<std::uint32_t>(neighbours.size()))]);
}

int DepthFirstPolicy::act_on(const Observation& observation) {
  for (const NodeId next : observation.world->open_neighbours(observation.position)) {
    if (!observation.visited(next)) return observation.action_to(next);
  }
  // The way from the root to here: a node entered for the first time goes on it, a step back takes one off.
  std::vector<NodeId> trail;
  std::vector<bool> seen(observation.visits.size());
  for (const NodeId node : observation.walk) {
    if (seen[node]) {
      trail.pop_back();
    } else {
      seen[node] = true;
      trail.push_back(node);
    }
  }
  return trail.size() < 2 ? kStop : observation.action_to(trail[trail.size() - 2]);
}

int NearestUnvisitedPolicy::act_on(const Observation& observation) {
  const World& world = *observation.world;
  const std::vector<NodeId> path = path_to_nearest(
      world.graph(), observation.position, [&](NodeId node) { return !observation.visited(node); },
      [&](NodeId node) { return !world.is_blocked(node); });
  return path.empty() ? kStop : observation.action_to(path.front());
}

}  // namespace graphdrl
