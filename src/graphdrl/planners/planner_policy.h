// Planners as policies: evaluation cannot tell them apart.
#pragma once

#include <memory>
#include <vector>

#include "graphdrl/env/policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Follows the plan of a planner and stops at its end. Plans at the start of a walk, and anew from where it stands once
// the walk has left its plan, more is known of the world [View::version()] or others have claimed nodes; what was left
// of the plan is where the planner goes on from then. Where more becomes known it plans a few steps ahead at a time.
class PlannerPolicy final : public Policy {
 public:
  explicit PlannerPolicy(std::unique_ptr<Planner> planner) : planner_(std::move(planner)) {}
  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock = {}) override;

 private:
  // A plan from somewhere on a walk, and the hash of that walk up to each of its steps, by which an episode is known to
  // be on it.
  struct Followed {
    Task task;              // of the whole walk
    std::uint64_t version;  // of what was known
    std::size_t before;     // steps of the walk before the plan
    std::vector<NodeId> walk;
    std::vector<std::uint64_t> hashes;  // as walk

    bool leads_on(const Observation& observation) const;
    std::span<const NodeId> rest(const Observation& observation) const;
  };

  int act_on(const Observation& observation, const Clock& clock);
  const Followed& plan_anew(const Observation& observation, const Clock& clock);

  std::unique_ptr<Planner> planner_;
  std::vector<Followed> plans_;  // the last ones, kMostPlans at most
  std::size_t oldest_ = 0;
};

}  // namespace graphdrl
