// Planners as policies: evaluation cannot tell them apart.
#pragma once

#include <memory>
#include <vector>

#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Follows the plan of a planner and stops at its end. Plans once for each start; where someone else led the way, it
// plans anew from there, step by step.
class PlannerPolicy final : public Policy {
 public:
  explicit PlannerPolicy(std::unique_ptr<Planner> planner) : planner_(std::move(planner)) {}
  void act(std::span<const Observation> observations, std::span<int> actions) override;

 private:
  // A plan, and the hash of the walk up to each of its steps, by which an episode is known to be on it.
  struct Followed {
    View view;
    NodeId start;
    NodeId end;
    double budget;
    std::vector<NodeId> walk;
    std::vector<std::uint64_t> hashes;  // as walk
  };

  int act_on(const Observation& observation);
  const Followed& plan_from_start(const Observation& observation);

  std::unique_ptr<Planner> planner_;
  std::vector<Followed> plans_;  // the last ones, kMostPlans at most
  std::size_t oldest_ = 0;
};

}  // namespace graphdrl
