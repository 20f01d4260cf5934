#include "graphdrl/env/observation.h"

#include <algorithm>

namespace graphdrl {

int action_to(const Observation& observation, NodeId next) {
  if (observation.action_space == ActionSpace::kDirections) {
    int action = 0;
    while (observation.world->direction_target(observation.position, action) != next) ++action;
    return action;
  }
  const auto neighbours = observation.world->open_neighbours(observation.position);
  return static_cast<int>(std::find(neighbours.begin(), neighbours.end(), next) - neighbours.begin());
}

}  // namespace graphdrl
