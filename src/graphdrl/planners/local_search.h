// Local search: improves a walk by taking out and putting back what it makes for.
#pragma once

#include <cstdint>
#include <memory>

#include "graphdrl/planners/plan.h"
#include "graphdrl/planners/targets.h"

namespace graphdrl {

inline constexpr std::int64_t kMostIterations = 1'000'000'000'000;

// Ruin and recreate [Schrimpf et al. 2000; strings as in Christiaens and Vanden Berghe 2020] with 2-opt [Croes 1958],
// under simulated annealing [Kirkpatrick, Gelatt and Vecchi 1983]; docs/search.md says how. Begins with the best walk
// of nearest, depth first, beam and explorer, each within its share of the time, and on large maps a covering walk; is
// never worse than that. Stops
// when the bound is met, which a linear program tightens first; with enough time left, branch and cut [LpBound] and
// annealing take turns. Chains, each with its own seed, run side by side. Walks over more than 5,000 nodes are first
// improved by parts [improve_by_parts()]. Without a deadline the walk depends on the task, the iterations and the seed
// alone, not on the number of threads.
class LocalSearchPlanner final : public Planner {
 public:
  // iterations: steps in all. 0: with a deadline as many as it allows, else for T targets min(3 T², max(550,000,
  // 100 T)), at least 10,000 and at most a million: about 0.1 s for 100 targets and 1 s for 400, on one thread; beyond
  // 5,000 nodes, a million in parts, and up to 20,000 nodes these steps after that.
  LocalSearchPlanner(std::int64_t iterations, std::uint64_t seed, std::unique_ptr<Planner> explorer)
      : iterations_(iterations), seed_(seed), explorer_(std::move(explorer)) {}

  Plan plan(const Task& task, const Clock& clock = {}) override;
  Plan plan_from(const Task& task, Plan known, const Clock& clock = {}) override;
  bool bounds() const override { return true; }

 private:
  Plan search(const Task& task, Plan best, const Clock& clock);
  Plan search_by_parts(const Task& task, Plan best, const Clock& clock);
  Plan best_start(const Task& task, Plan best, const Clock& clock);
  Plan anneal(const Task& task, const Targets& targets, Plan best, std::int64_t steps, Clock clock);

  std::int64_t iterations_;
  std::uint64_t seed_;
  std::unique_ptr<Planner> explorer_;
};

}  // namespace graphdrl
