// Local search: improves a walk by taking out and putting back what it makes for.
#pragma once

#include <cstdint>
#include <memory>

#include "graphdrl/planners/plan.h"
#include "graphdrl/planners/targets.h"

namespace graphdrl {

inline constexpr std::int64_t kMostIterations = 1'000'000'000'000;

struct LocalSearchOptions {
  std::int64_t iterations =
      0;  // in all; 0: as many as default_iterations() says, or without end until the clock passes
  std::uint64_t seed = 1;
};

// Of a task with so many nodes to visit, on one thread: about 0.1 s for 100 nodes, 1 s for 400.
std::int64_t default_iterations(int targets);

// Ruin and recreate [Schrimpf et al. 2000; strings as in Christiaens and Vanden Berghe 2020] with 2-opt [Croes 1958],
// under simulated annealing [Kirkpatrick, Gelatt and Vecchi 1983]; docs/search.md says how. Begins with the best of
// nearest, depth first, beam and explorer, each as far as it ends within its share of the time, and is never worse than
// the best of these. Stops where the bound is met, which a linear program's root tightens first; where there is time,
// branch and cut [LpBound] goes on in between. Chains with seeds of their own run side by side. Without a deadline the
// walk depends on the task and the options alone, not on the number of threads.
class LocalSearchPlanner final : public Planner {
 public:
  LocalSearchPlanner(LocalSearchOptions options, std::unique_ptr<Planner> explorer)
      : options_(options), explorer_(std::move(explorer)) {}

  Plan plan(const Task& task, const Clock& clock = {}) override;
  Plan plan_from(const Task& task, Plan known, const Clock& clock = {}) override;
  bool bounds() const override { return true; }

 private:
  Plan search(const Task& task, Plan best, const Clock& clock);
  Plan best_start(const Task& task, const Targets& targets, Plan best, const Clock& clock);
  Plan anneal(const Task& task, const Targets& targets, Plan best, std::int64_t steps, Clock clock);

  LocalSearchOptions options_;
  std::unique_ptr<Planner> explorer_;
};

}  // namespace graphdrl
