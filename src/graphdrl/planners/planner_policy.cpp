#include "graphdrl/planners/planner_policy.h"

#include <algorithm>
#include <stdexcept>

#include "graphdrl/env/exploration.h"

namespace graphdrl {
namespace {

constexpr std::size_t kMostPlans = 64;  // as many as the episodes of a block in eval/rollout
// On an unknown map a plan spends no more than so many mean edges, or than so many times the way to the nearest first
// visit, whichever is more, and the way to the end: what lies farther off is better chosen once more is known. Of 2, 5
// and no limit, 2 is best by far (docs/unknown.md).
constexpr double kHorizon = 2;

double horizon_of(const Observation& now) {
  if (!now.view().grows()) return kNoLimit;
  NearestFirst search;
  const FirstVisit nearest = Exploration(now, now.ground()).nearest_first_visit(search);
  double to_end = now.task->cost_to_end(now.position);
  if (nearest.node != kNoNode) to_end = std::max(to_end, now.task->cost_to_end(nearest.node));
  return to_end + kHorizon * std::max(now.view().open().mean_cost(), nearest.cost);
}

}  // namespace

void PlannerPolicy::act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock) {
  for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = act_on(observations[i], clock);
}

bool PlannerPolicy::Followed::leads_on(const Observation& observation) const {
  const std::size_t step = observation.walk.size() - 1;
  return step >= before && step - before < walk.size() && hashes[step - before] == observation.walk_hash &&
         task.end() == observation.task->end() && task.budget() == observation.task->budget();
}

std::span<const NodeId> PlannerPolicy::Followed::rest(const Observation& observation) const {
  return std::span(walk).subspan(observation.walk.size() - 1 - before);
}

const PlannerPolicy::Followed& PlannerPolicy::plan_anew(const Observation& observation, const Clock& clock) {
  const Task& whole = *observation.task;
  const bool whole_walk = observation.walk.size() == 1 && !whole.view().grows();
  const double left = std::max(0.0, whole.budget() - observation.spent);
  const auto with_budget = [&](double budget) {
    return whole.rest(observation.position, budget, observation.ground());
  };
  const Task task = whole_walk ? whole : with_budget(std::min(left, horizon_of(observation)));
  const auto older = std::find_if(plans_.begin(), plans_.end(), [&](const Followed& plan) {
    return plan.task.view() == whole.view() && plan.leads_on(observation);
  });
  Plan plan;
  if (older != plans_.end() && can_walk(task, older->rest(observation))) {
    const std::span<const NodeId> rest = older->rest(observation);
    plan = planner_->plan_from(task, plan_of_walk(task, {rest.begin(), rest.end()}), clock);
  } else {
    plan = planner_->plan(task, clock);
  }
  // Nothing near is worth anything.
  if (!whole_walk && plan.prize <= 0 && task.budget() < left) plan = planner_->plan(with_budget(left), clock);
  Followed followed{.task = whole,
                    .version = whole.view().version(),
                    .before = observation.walk.size() - 1,
                    .walk = std::move(plan.walk),
                    .hashes = {observation.walk_hash}};
  for (std::size_t i = 1; i < followed.walk.size(); ++i) {
    followed.hashes.push_back(extended_walk_hash(followed.hashes.back(), followed.walk[i]));
  }
  if (older != plans_.end()) return *older = std::move(followed);
  if (plans_.size() < kMostPlans) return plans_.emplace_back(std::move(followed));
  return plans_[oldest_++ % kMostPlans] = std::move(followed);
}

int PlannerPolicy::act_on(const Observation& observation, const Clock& clock) {
  const auto known = std::find_if(plans_.begin(), plans_.end(), [&](const Followed& plan) {
    return plan.task.view() == observation.view() && plan.version == observation.view().version() &&
           plan.leads_on(observation) && plan.task.has_sets_of(*observation.task);
  });
  const std::span<const NodeId> rest =
      (known != plans_.end() ? *known : plan_anew(observation, clock)).rest(observation);
  if (rest.size() < 2) return kStop;
  const int action = observation.action_to(rest[1]);
  if (action == kNoAction || !observation.affordable(action)) {
    throw std::logic_error("a plan takes a step that cannot be taken");
  }
  return action;
}

}  // namespace graphdrl
