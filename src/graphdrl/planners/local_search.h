// Local search: improves a walk by taking out and putting back what it makes for.
#pragma once

#include <cstdint>
#include <memory>

#include "graphdrl/planners/annealing_options.h"
#include "graphdrl/planners/plan.h"
#include "graphdrl/planners/targets.h"

namespace graphdrl {

inline constexpr std::int64_t kMostIterations = 1'000'000'000'000;

// Defaults are those by which the search visits most on worlds of the validation split (docs/search.md).
struct LocalSearchOptions {
  // Steps in all. 0: with a deadline as many as it allows, else for T targets min(3 T², max(550,000, 100 T)), at least
  // 10,000 and at most large_steps: about 0.1 s for 100 targets and 1 s for 400, on one thread.
  std::int64_t iterations = 0;
  std::uint64_t seed = 1;
  AnnealingOptions annealing = {};

  // Where the choice of targets matters [Annealing::is_selective()], a chain keeps a population of routes.
  struct Population {
    int size = 8;
    double first_share = 0.4;  // of the schedule, for the first routes
    int children = 64;         // each of two routes
    double last_share = 0.1;   // of the schedule, for the last run, from the best route
    double warm = 0.6;  // of the way from the first temperature to the last: children and the last run begin there
  };
  Population population = {};

  // With a deadline: shares of the time left.
  double targets_share = 0.5;  // for the costs between targets, at most
  double bound_share = 0.05;   // for the knapsack bound, and again for the root of the linear program
  double start_share = 0.05;   // for each walk to start with but nearest
  // Without a deadline: LpBound::Effort::work.
  double root_work = 1e7;    // at most about 0.3 s
  double branch_work = 2e6;  // once the search is over

  double explorer_visit_s = 0.4e-3;  // seconds a first visit: the explorer is not begun where it would not end
  double step_s = 5e-6;              // seconds a step, about
  double branch_from = 4;            // branch only if the time left is over this many searches; it then gets one's time
  double walk_times = 2;             // time kept for the last walk, in times that the walk of the start takes
  int chains = 2;                    // without a deadline, so that the walk does not depend on the number of threads
  int steps_per_look = 16;           // at the clock
  // At most large_steps up to large_targets targets, and fewer by the square of their number beyond: in caves of
  // 512x512 cells at 0.5x a step takes several milliseconds, and ten minutes of steps visit no more than none.
  double large_steps = 1e6;
  double large_targets = 1e4;
};

// Ruin and recreate [Schrimpf et al. 2000; strings as in Christiaens and Vanden Berghe 2020] with 2-opt [Croes 1958],
// under simulated annealing [Kirkpatrick, Gelatt and Vecchi 1983]; docs/search.md says how. Begins with the best walk
// of nearest, depth first, beam and explorer, each within its share of the time, and is never worse than that. Stops
// when the bound is met, which a linear program tightens first; with enough time left, branch and cut [LpBound] and
// annealing take turns. Chains, each with its own seed, run side by side. Without a deadline the walk depends on the
// task and the options alone, not on the number of threads.
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
