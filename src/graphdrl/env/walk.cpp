#include "graphdrl/env/walk.h"

#include <fmt/format.h>

#include "graphdrl/base/error.h"

namespace graphdrl {

void follow_walk(Episode& episode, std::span<const NodeId> walk,
                 const std::function<void(const Observation&)>& at_node) {
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start"});
  episode.reset(walk.front());
  if (at_node) at_node(episode.observation());
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const int action = episode.observation().action_to(walk[i]);
    if (action == kNoAction) {
      throw Error({.what = "no such step in the walk",
                   .expected = fmt::format("a valid neighbour of node {}, or the node again for a blocked move",
                                           episode.position()),
                   .got = fmt::format("{} at place {}", walk[i], i),
                   .where = episode.world().name()});
    }
    if (!episode.observation().affordable(action)) {
      throw Error({.what = "the walk costs more than the budget",
                   .got = fmt::format("step {} from {} to {}", i, episode.position(), walk[i]),
                   .where = episode.world().name()});
    }
    episode.step(action);
    if (at_node) at_node(episode.observation());
  }
}

}  // namespace graphdrl
