#include "graphdrl/planners/planner_policy.h"

#include <algorithm>
#include <stdexcept>

namespace graphdrl {
namespace {

constexpr std::size_t kMostPlans = 64;  // as many as the episodes of a block in eval/rollout

}  // namespace

void PlannerPolicy::act(std::span<const Observation> observations, std::span<int> actions) {
  for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = act_on(observations[i]);
}

const PlannerPolicy::Followed& PlannerPolicy::plan_from_start(const Observation& observation) {
  const NodeId start = observation.walk.front();
  const auto known = std::find_if(plans_.begin(), plans_.end(), [&](const Followed& plan) {
    return plan.start == start && plan.end == observation.end && plan.budget == observation.budget &&
           plan.view == *observation.view;
  });
  if (known != plans_.end()) return *known;
  const Task task{.view = *observation.view, .start = start, .budget = observation.budget, .end = observation.end};
  Followed plan{.view = task.view,
                .start = start,
                .end = task.end,
                .budget = task.budget,
                .walk = planner_->plan(task).walk,
                .hashes = {}};
  std::uint64_t hash = kEmptyWalkHash;
  for (const NodeId node : plan.walk) plan.hashes.push_back(hash = extended_walk_hash(hash, node));
  if (plans_.size() < kMostPlans) return plans_.emplace_back(std::move(plan));
  Followed& place = plans_[oldest_++ % kMostPlans];
  place = std::move(plan);
  return place;
}

int PlannerPolicy::act_on(const Observation& observation) {
  const Followed& plan = plan_from_start(observation);
  const std::size_t step = observation.walk.size() - 1;
  const auto follow = [&](std::span<const NodeId> rest) {  // from here on
    if (rest.size() < 2) return kStop;
    const int action = observation.action_to(rest[1]);
    if (action == kNoAction || !observation.affordable(action)) {
      throw std::logic_error("a plan takes a step that cannot be taken");
    }
    return action;
  };
  if (step < plan.walk.size() && plan.hashes[step] == observation.walk_hash) {
    return follow(std::span(plan.walk).subspan(step));
  }
  Task task{.view = *observation.view,
            .start = observation.position,
            .budget = std::max(0.0, observation.budget - observation.spent),
            .end = observation.end,
            .visited = NodeSet(observation.view->node_count())};
  for (const NodeId node : observation.walk) task.visited.insert(node);
  return follow(planner_->plan(task).walk);
}

}  // namespace graphdrl
