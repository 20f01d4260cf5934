// Walks that explore, for the tests of what shows them.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "graphdrl/answer/answer.h"
#include "graphdrl/env/discovery.h"

namespace graphdrl {

// The answer that has this walk, and what its visits show.
inline Answer explored(const World& world, std::string_view reveal, std::vector<NodeId> walk) {
  const Task task(world, walk.front(), 1000);
  Answer answer{.world = world, .task = task, .policy = "mine", .plan = plan_of_walk(task, std::move(walk))};
  answer.reveal = Reveal::parse(reveal);
  HiddenWorld hidden(world, answer.reveal, answer.score, answer.plan.walk.front(), /*seed=*/1);
  for (const NodeId node : answer.plan.walk) {
    hidden.visit(hidden.known_as(node));
    answer.discovered.after_step.push_back(hidden.view().valid_count());
  }
  for (NodeId node = 0; node < hidden.view().valid_count(); ++node) {
    answer.discovered.nodes.push_back(hidden.in_world(node));
  }
  return answer;
}

}  // namespace graphdrl
