// One task answered: the plan, its bound, and what is said beside them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// A plan, and what is said beside it.
struct PlanReport {
  World world;
  Task task;
  std::string policy;  // as users name it
  Plan plan;
  int max_visited = 0;  // by any walk, at most; where there are no prizes
  int unreachable = 0;  // valid nodes that no walk can reach, whatever it spends
  double elapsed_s = 0;
};

struct PlanRequest {
  std::string policy = "search";  // as make_policy() takes it
  std::uint64_t seed = 1;         // of `search` and of random policies
  std::optional<double> time_limit_s = {};
  // One of these instead of a policy that has a name here; `policy` is then what it is called.
  std::function<std::unique_ptr<Planner>()> own_planner = {};
  std::function<std::unique_ptr<Policy>()> own_policy = {};
};

// Plans one walk and bounds it, both within the time limit. Throws Error on a policy that there is not, and on a task
// or a time limit that cannot be.
PlanReport make_plan(const World& world, const Task& task, const PlanRequest& request, const Report& report = {});

}  // namespace graphdrl
