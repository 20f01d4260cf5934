#include "graphdrl/env/walk.h"

#include <fmt/format.h>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

// The action that leads to `next`; where `next` is the node itself, the first blocked direction. -1 where there is
// none.
int find_action(const Observation& observation, NodeId next) {
  const World& world = *observation.world;
  for (int action = 0; action < observation.action_count(); ++action) {
    const NodeId target = observation.action_space == ActionSpace::kDirections
                              ? world.direction_target(observation.position, action)
                              : world.open_neighbours(observation.position)[action];
    if (target == next) return action;
  }
  return -1;
}

}  // namespace

void follow_walk(Episode& episode, std::span<const NodeId> walk,
                 const std::function<void(const Observation&)>& at_node) {
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start"});
  episode.reset(walk.front());
  if (at_node) at_node(episode.observation());
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const int action = find_action(episode.observation(), walk[i]);
    if (action < 0) {
      throw Error({.what = "no such step in the walk",
                   .expected = fmt::format("a valid neighbour of node {}, or the node again for a blocked move",
                                           episode.position()),
                   .got = fmt::format("{} at place {}", walk[i], i),
                   .where = episode.world().name()});
    }
    episode.step(action);
    if (at_node) at_node(episode.observation());
  }
}

}  // namespace graphdrl
