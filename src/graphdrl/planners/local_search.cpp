#include "graphdrl/planners/local_search.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "graphdrl/base/parallel.h"
#include "graphdrl/planners/annealing.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

using std::chrono::steady_clock;

constexpr int kChains = 2;           // without a deadline, whatever the number of threads
constexpr double kStartShare = 0.05;  // of the time left, for each walk to start with but the first two
constexpr double kExplorerVisitS = 0.4e-3;  // a first visit of the explorer: it is not begun where it would not end
constexpr double kBoundShare = 0.05;
constexpr int kStarts = 9;            // where the choice matters: eight short runs and a long one from the best
constexpr double kStartsShare = 0.6;  // of the time, for the short ones
constexpr int kStepsPerLook = 16;  // at the clock; a step takes some microseconds
constexpr int kMostThreads = 64;

Deadline share_of(Deadline deadline, double share) {
  if (!deadline) return std::nullopt;
  const auto now = steady_clock::now();
  return now + std::chrono::duration_cast<steady_clock::duration>(share * (*deadline - now));
}

// What a walk makes for: its targets in the order of first visits, and the costs of the ways to each, and to the end.
struct Stops {
  std::vector<int> order;
  std::vector<double> links;
};

Stops stops_of(const Task& task, const Targets& targets, std::span<const NodeId> walk) {
  Stops stops;
  std::vector<char> taken(targets.end());
  double cost = 0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const Graph& open = task.view.open();
    cost += open.cost(walk[i - 1], open.index_of(walk[i - 1], walk[i]));
    const int target = targets.target_of(walk[i]);
    if (target <= 0 || taken[target] != 0) continue;
    taken[target] = 1;
    stops.order.push_back(target);
    stops.links.push_back(cost);
    cost = 0;
  }
  stops.links.push_back(task.ends_anywhere() ? 0 : cost);
  return stops;
}

// The walk that makes for these targets, each by a cheapest way, and for the end.
std::vector<NodeId> walk_of(const Task& task, const Targets& targets, std::span<const int> order) {
  NearestFirst search;
  std::vector<NodeId> walk = {task.start};
  for (const int target : order) append_way_to(task.view, targets.node(target), walk, search);
  append_way_to_end(task, walk, search);
  return walk;
}

}  // namespace

std::int64_t default_iterations(int targets) {
  const auto count = static_cast<std::int64_t>(targets);
  return std::clamp<std::int64_t>(3 * count * count, 10'000, std::max<std::int64_t>(600'000, 100 * count));
}

Plan LocalSearchPlanner::plan(const Task& task, Deadline deadline, const Report& report) {
  check(task);
  NearestPlanner nearest;
  Plan best = nearest.plan(task, deadline, report);
  const auto consider = [&](Planner& planner, Deadline until) {
    best = better_of(std::move(best), planner.plan(task, until, report));
  };
  const Targets targets(task, deadline);
  const double bound = std::min(max_prize(task, share_of(deadline, kBoundShare)), targets.total_prize());
  const auto met_bound = [&](double prize) { return prize >= bound * (1 - kPrizeRounding); };
  DepthFirstPlanner depth_first;
  BeamPlanner beam{BeamOptions()};
  const std::chrono::duration<double> explorer_time(kExplorerVisitS * targets.end());
  for (Planner* const planner : {static_cast<Planner*>(&depth_first), static_cast<Planner*>(&beam), explorer_.get()}) {
    if (met_bound(best.prize) || passed(deadline)) break;
    const Deadline until = share_of(deadline, kStartShare);
    if (planner == explorer_.get() && until && steady_clock::now() + explorer_time > *until) continue;
    consider(*planner, until);
  }

  if (targets.complete() && targets.end() > 1 && !met_bound(best.prize) && !passed(deadline)) {
    const Stops stops = stops_of(task, targets, best.walk);
    const int chains = deadline ? std::min(threads(), kMostThreads) : kChains;
    const std::int64_t in_all = options_.iterations > 0 ? options_.iterations : default_iterations(targets.end());
    const bool endless = deadline && options_.iterations == 0;
    const std::int64_t steps = endless ? std::numeric_limits<std::int64_t>::max() : (in_all + chains - 1) / chains;
    // What comes after the last step takes about as long as this.
    const auto before = steady_clock::now();
    walk_of(task, targets, stops.order);
    const auto begin = steady_clock::now();
    if (deadline) *deadline -= 2 * (begin - before);
    const double time = deadline ? std::chrono::duration<double>(*deadline - begin).count() : 0;
    const int before_walk = task.visited_before().count() + (targets.prize(targets.end()) > 0 ? 1 : 0);
    const auto caller = std::this_thread::get_id();
    std::vector<Plan> found(chains);
    const int starts = Annealing::is_selective(targets, best.prize) ? kStarts : 1;
    parallel_for(chains, [&](int chain) {
      Stops from = stops;
      double prize = -1;
      // Runs of one schedule each, the last one from the best of those before it.
      for (int run = 0; run < starts; ++run) {
        const bool last = run == starts - 1;
        const double first_share = starts == 1 ? 0 : run * kStartsShare / (starts - 1);
        const double last_share = last ? 1 : first_share + kStartsShare / (starts - 1);
        const auto seed = static_cast<std::uint64_t>(chain * kStarts + run);
        Annealing annealing(targets, task.limit(), derive_seed(options_.seed, 0, seed));
        const Stops& start = last ? from : stops;
        annealing.start(start.order, start.links);
        const auto first_step = static_cast<std::int64_t>(first_share * static_cast<double>(steps));
        const auto last_step = static_cast<std::int64_t>(last_share * static_cast<double>(steps));
        double through = 0;
        for (std::int64_t step = first_step; (endless || step < last_step) && !met_bound(annealing.best_prize()); ++step) {
          if (step % kStepsPerLook == 0) {
            const double elapsed =
                deadline ? std::chrono::duration<double>(steady_clock::now() - begin).count() / time : 0;
            if (elapsed >= last_share || passed(deadline)) break;
            through = (elapsed - first_share) / (last_share - first_share);
            if (report && std::this_thread::get_id() == caller) {
              report({.visited = before_walk + annealing.best_visits(), .bound = bound});
            }
          }
          const double stepped = endless ? 0 : static_cast<double>(step - first_step) / static_cast<double>(last_step - first_step);
          annealing.step(std::clamp(std::max(through, stepped), 0.0, 1.0));
        }
        const std::vector<int>& order = annealing.best();
        if (annealing.best_prize() <= prize) continue;
        prize = annealing.best_prize();
        from = {order, annealing.best_links()};
      }
      found[chain] = plan_of_walk(task, walk_of(task, targets, from.order));
    });
    for (Plan& plan : found) {
      if (plan.cost <= task.limit()) best = better_of(std::move(best), std::move(plan));
    }
  }
  best.bound = bound;
  best.optimal = best.optimal || met_bound(best.prize);
  return best;
}

}  // namespace graphdrl
