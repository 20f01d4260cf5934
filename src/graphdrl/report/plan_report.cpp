#include "graphdrl/report/plan_report.h"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

#include "graphdrl/base/error.h"
#include "graphdrl/env/walk.h"
#include "graphdrl/eval/rollout.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

// Of a time limit: the bound may take a share of it before planning, and what comes after planning has the rest.
constexpr double kBoundShare = 0.3;
constexpr double kPlanShare = 0.97;
constexpr double kMostSeconds = 1e6;
constexpr double kRounding = 1e-9;  // of sums of prizes

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void check_time_limit(const PlanRequest& request) {
  if (request.time_limit_s && !(*request.time_limit_s >= 0 && *request.time_limit_s <= kMostSeconds)) {
    throw Error({.what = "bad time limit",
                 .expected = fmt::format("0 to {:.0f} seconds", kMostSeconds),
                 .got = fmt::format("{}", *request.time_limit_s)});
  }
}

// Null if the policy chooses step by step.
std::unique_ptr<Planner> planner_of(const PlanRequest& request) {
  if (request.own_planner) return request.own_planner();
  return request.own_policy ? nullptr : make_planner(request.policy, request.seed);
}

std::unique_ptr<Policy> policy_of(const PlanRequest& request) {
  return request.own_policy ? request.own_policy() : make_policy(request.policy, request.seed);
}

int count_unreachable(const World& world, NodeId start) {
  int reached = 1;
  NearestFirst().run(world.open(), start, kNoLimit, [&](NodeId, double) {
    ++reached;
    return NearestFirst::Next::kThrough;
  });
  return world.valid_count() - reached;
}

// Walks the plan through an episode before it is believed.
void check_plan(const World& world, const Task& task, const Plan& plan) {
  const End end = task.ends_anywhere() ? End::anywhere() : End::at(task.end);
  Episode episode(world, {.budget = task.budget, .end = end, .action_space = action_space_of(world)});
  follow_walk(episode, plan.walk);
  const bool ends_well = task.ends_anywhere() || episode.position() == task.end;
  if (!ends_well || episode.visited_count() != plan.visited) throw std::logic_error("the plan is not what it says");
}

}  // namespace

PlanReport make_plan(const World& world, const Task& task, const PlanRequest& request, const Report& report) {
  check_time_limit(request);
  const auto begin = std::chrono::steady_clock::now();
  const auto deadline = [&](double share) -> Deadline {
    if (!request.time_limit_s) return std::nullopt;
    return begin + std::chrono::duration_cast<std::chrono::nanoseconds>(
                       std::chrono::duration<double>(share * *request.time_limit_s));
  };
  const bool own = request.own_planner || request.own_policy;
  PlanReport answer{
      .world = world, .task = task, .policy = own ? request.policy : policy_label(request.policy), .plan = {}};
  const auto planner = planner_of(request);
  const bool bounds = planner != nullptr && planner->bounds();
  const double bound = bounds ? kNoLimit : max_prize(task, deadline(kBoundShare));
  if (planner != nullptr) {
    answer.plan = planner->plan(task, deadline(kPlanShare), report);
  } else {
    answer.plan = plan_by_steps(world, task, *policy_of(request), deadline(kPlanShare), report);
  }
  Plan& plan = answer.plan;
  check_plan(world, task, plan);
  plan.bound = std::min(plan.bound, bound);
  plan.optimal = plan.optimal || plan.prize >= plan.bound * (1 - kRounding);
  if (plan.optimal) plan.bound = plan.prize;
  if (!world.has_prizes()) answer.max_visited = static_cast<int>(plan.bound);
  answer.unreachable = count_unreachable(world, task.start);
  answer.elapsed_s = seconds_since(begin);
  return answer;
}

}  // namespace graphdrl
