#include "graphdrl/planners/local_search.h"

#include <algorithm>
#include <initializer_list>
#include <thread>

#include "graphdrl/base/parallel.h"
#include "graphdrl/planners/annealing.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/lp_bound.h"

namespace graphdrl {
namespace {

constexpr int kChains = 2;                  // without a deadline, whatever the number of threads
constexpr double kStartShare = 0.05;        // of the time left, for each walk to start with but the first two
constexpr double kExplorerVisitS = 0.4e-3;  // a first visit of the explorer: it is not begun where it would not end
constexpr double kTargetsShare = 0.5;       // at most; what is left of it goes to the search
constexpr double kBoundShare = 0.05;        // of the time left, for the knapsack bound, and again for the root's
constexpr double kRootWork = 1e7;           // without a deadline, of the linear program: at most about 0.3 s
constexpr double kBranchWork = 2e6;         // likewise, of branching once the search is over
constexpr double kStepS = 5e-6;             // a step takes about as long
// Branch only if the time left is over 4 such searches; branching then gets one search's time.
constexpr double kLongTime = 4;
constexpr double kWalkTime = 2;  // of the time that a walk of all targets takes, kept for the last one
// So many steps at most with 10,000 targets, and fewer by the square of their number beyond. In caves of 512x512 cells
// at 0.5x a step takes several milliseconds, and ten minutes of steps visit no more than none.
constexpr double kDearSteps = 1e6;
constexpr double kDearTargets = 1e4;
// Where the choice matters:
constexpr int kPopulation = 8;
constexpr double kFirstShare = 0.4;  // of the schedule, for the first population
constexpr int kChildren = 64;
constexpr double kLastShare = 0.1;  // of the schedule, for the last run from the best
constexpr double kWarm = 0.6;       // of the way from the first temperature to the last: where children begin
constexpr int kStepsPerLook = 16;   // at the clock; a step takes some microseconds

// What a walk makes for: its targets in the order of first visits, and the costs of the ways to each, and to the end.
struct Tour {
  std::vector<int> order;
  std::vector<double> links;
  double prize;
};

Tour tour_of(const Task& task, const Targets& targets, const Plan& plan) {
  const std::vector<NodeId>& walk = plan.walk;
  Tour tour{.order = {}, .links = {}, .prize = plan.prize};
  std::vector<char> taken(targets.end());
  double cost = 0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const Graph& open = task.view().open();
    cost += open.cost(walk[i - 1], open.index_of(walk[i - 1], walk[i]));
    const int target = targets.target_of(walk[i]);
    if (target <= 0 || taken[target] != 0) continue;
    taken[target] = 1;
    tour.order.push_back(target);
    tour.links.push_back(cost);
    cost = 0;
  }
  tour.links.push_back(task.ends_anywhere() ? 0 : cost);
  return tour;
}

// The walk that makes for these targets, each by a cheapest way, and for the end.
std::vector<NodeId> walk_of(const Task& task, const Targets& targets, std::span<const int> order) {
  NearestFirst search;
  std::vector<NodeId> walk = {task.start()};
  for (const int target : order) append_way_to(task.view(), targets.node(target), walk, search);
  append_way_to_end(task, walk, search);
  return walk;
}

// How much there is to do: so many steps, or until a deadline, or both.
class CoolingSchedule {
 public:
  // steps: 0 where the deadline alone counts.
  CoolingSchedule(std::int64_t steps, const Clock& clock) : steps_(steps), clock_(clock), time_(clock.seconds_left()) {}

  // The share that is over after so many steps.
  double done(std::int64_t steps) const {
    double share = steps_ > 0 ? static_cast<double>(steps) / static_cast<double>(steps_) : 0;
    if (clock_.has_deadline()) share = std::max(share, time_ > 0 ? 1 - clock_.seconds_left() / time_ : 1);
    return clock_.stopped() ? 1 : share;
  }
  // How many steps to take before the next look at it, after so many.
  int steps_to_look(std::int64_t steps) const {
    return steps_ == 0 ? kStepsPerLook : static_cast<int>(std::min<std::int64_t>(kStepsPerLook, steps_ - steps));
  }

 private:
  std::int64_t steps_;
  Clock clock_;
  double time_;  // seconds in all
};

// What the chains of one task share.
struct Chains {
  const Task& task;
  const Targets& targets;
  const CoolingSchedule& schedule;
  double bound;
  std::function<void(int visits)> tell;

  // A part of the schedule, and how far annealing is where it begins.
  struct Part {
    double first;
    double last;
    double progress = 0;
  };

  // One run. steps: taken by the chain up to now.
  Tour run(Annealing& annealing, const Part& part, std::int64_t& steps) const {
    for (double done = schedule.done(steps); done < part.last && !meets(annealing.best_prize(), bound);
         done = schedule.done(steps)) {
      const double share = std::clamp((done - part.first) / (part.last - part.first), 0.0, 1.0);
      const double progress = part.progress + (1 - part.progress) * share;
      const int count = schedule.steps_to_look(steps);
      for (int i = 0; i < count && !meets(annealing.best_prize(), bound); ++i) annealing.step(progress);
      steps += count;
      tell(annealing.best_visits());
    }
    const std::vector<int>& order = annealing.best();
    return {order, annealing.best_links(), annealing.best_prize()};
  }

  Annealing begin(const Tour& start, std::uint64_t seed) const {
    Annealing annealing(targets, task.limit(), seed);
    annealing.start(start.order, start.links);
    return annealing;
  }

  // Where the choice matters, a population; else one run.
  Tour chain(const Tour& start, std::uint64_t seed) const {
    std::int64_t steps = 0;
    Annealing annealing = begin(start, derive_seed(seed, 0));
    if (!Annealing::is_selective(targets, start.prize)) return run(annealing, {.first = 0, .last = 1}, steps);
    const Tour best = best_of_population(start, seed, steps);
    annealing.start(best.order, best.links);
    return run(annealing, {.first = 1 - kLastShare, .last = 1, .progress = kWarm}, steps);
  }

  // Short runs, then children of any two: each takes the place of the worst route, if it is better and new.
  Tour best_of_population(const Tour& start, std::uint64_t seed, std::int64_t& steps) const {
    std::vector<Tour> routes(kPopulation, start);
    for (int i = 0; i < kPopulation && schedule.done(steps) < kFirstShare; ++i) {
      Annealing annealing = begin(start, derive_seed(seed, 1, static_cast<std::uint64_t>(i)));
      const double first = kFirstShare * i / kPopulation;
      routes[i] = run(annealing, {.first = first, .last = first + kFirstShare / kPopulation}, steps);
    }
    const auto by_prize = [](const Tour& a, const Tour& b) { return a.prize < b.prize; };
    Rng rng(derive_seed(seed, 2));
    constexpr double kShare = (1 - kFirstShare - kLastShare) / kChildren;
    for (int i = 0; i < kChildren; ++i) {
      const double first = kFirstShare + kShare * i;
      if (schedule.done(steps) >= first + kShare) continue;
      const auto one = rng.below(kPopulation);
      const auto other = (one + 1 + rng.below(kPopulation - 1)) % kPopulation;
      Annealing annealing = begin(routes[one], derive_seed(seed, 3, static_cast<std::uint64_t>(i)));
      annealing.recombine(routes[other].order);
      Tour child = run(annealing, {.first = first, .last = first + kShare, .progress = kWarm}, steps);
      const auto worst = std::min_element(routes.begin(), routes.end(), by_prize);
      const bool is_new = std::none_of(routes.begin(), routes.end(), [&](const Tour& route) {
        return route.order == child.order ||
               std::equal(route.order.rbegin(), route.order.rend(), child.order.begin(), child.order.end());
      });
      if (is_new && child.prize > worst->prize) *worst = std::move(child);
    }
    return *std::max_element(routes.begin(), routes.end(), by_prize);
  }
};

}  // namespace

std::int64_t default_iterations(int targets) {
  const auto count = static_cast<std::int64_t>(targets);
  const double dearness = std::max(1.0, static_cast<double>(targets) / kDearTargets);
  const auto dear = static_cast<std::int64_t>(kDearSteps / (dearness * dearness));
  const std::int64_t most = std::min(std::max<std::int64_t>(550'000, 100 * count), dear);
  return std::max<std::int64_t>(std::min(3 * count * count, most), 10'000);
}

Plan LocalSearchPlanner::plan(const Task& task, const Clock& clock) {
  return search(task, NearestPlanner().plan(task, clock), clock);
}

Plan LocalSearchPlanner::plan_from(const Task& task, Plan known, const Clock& clock) {
  known.bound = kNoLimit;
  return search(task, better_of(std::move(known), NearestPlanner().plan(task, clock)), clock);
}

// best: the best walk up to now.
Plan LocalSearchPlanner::search(const Task& task, Plan best, const Clock& clock) {
  const Targets targets(task, clock.share(kTargetsShare));
  best.bound = std::min(max_prize(task, clock.share(kBoundShare)), targets.total_prize());
  std::unique_ptr<LpBound> lp;
  if (!meets(best.prize, best.bound) && !clock.passed()) lp = make_lp_bound(task, best.bound);
  if (lp != nullptr) {
    lp->cut(best.prize, {.clock = clock.share(kBoundShare), .work = clock.has_deadline() ? kNoLimit : kRootWork});
    best.bound = std::min(best.bound, lp->bound());
  }
  best = best_start(task, targets, std::move(best), clock);
  const auto search_for = [&](std::int64_t steps) {
    if (meets(best.prize, best.bound) || !targets.complete() || targets.end() <= 1 || clock.passed()) return;
    best = anneal(task, targets, std::move(best), steps, clock);
  };
  const auto branch = [&](const LpBound::Effort& effort) {
    if (lp == nullptr || meets(best.prize, best.bound)) return;
    lp->branch(best.prize, effort);
    improve(*lp, task, best);
  };
  std::int64_t steps = default_iterations(targets.end());
  if (!clock.has_deadline() || options_.iterations > 0) {
    search_for(options_.iterations > 0 ? options_.iterations : steps);
    branch({.clock = clock, .work = kBranchWork});
  } else {
    // Both in turn, longer and longer, while there is time for more than the next turn: the last search has the rest.
    while (lp != nullptr && !meets(best.prize, best.bound) &&
           clock.seconds_left() > kLongTime * kStepS * static_cast<double>(steps)) {
      const Stopwatch watch;
      search_for(steps);
      branch({.clock = clock.at_most(watch.seconds())});
      steps *= 2;
    }
    search_for(0);
  }
  best.settle(best.bound);
  return best;
}

// The best of all walks to begin with.
Plan LocalSearchPlanner::best_start(const Task& task, const Targets& targets, Plan best, const Clock& clock) {
  const double bound = best.bound;
  DepthFirstPlanner depth_first;
  BeamPlanner beam{BeamOptions()};
  for (Planner* const planner : std::initializer_list<Planner*>{&depth_first, &beam, explorer_.get()}) {
    if (meets(best.prize, bound) || clock.passed()) break;
    if (planner == &beam && !beam_fits(task.view(), BeamOptions())) continue;
    const Clock until = clock.share(kStartShare);
    if (planner == explorer_.get() && kExplorerVisitS * targets.end() > until.seconds_left()) continue;
    best = better_of(std::move(best), planner->plan(task, until));
    if (best.optimal) break;
  }
  best.bound = best.optimal ? best.prize : bound;
  return best;
}

// In so many steps, or until the clock passes where that is 0, or both.
Plan LocalSearchPlanner::anneal(const Task& task, const Targets& targets, Plan best, std::int64_t steps, Clock clock) {
  const Tour start = tour_of(task, targets, best);
  // What comes after the last step takes about as long as this.
  const Stopwatch watch;
  walk_of(task, targets, start.order);
  clock = clock.sooner(kWalkTime * watch.seconds());
  const int count = clock.has_deadline() ? threads() : kChains;
  const CoolingSchedule schedule((steps + count - 1) / count, clock);
  const auto caller = std::this_thread::get_id();
  const int visited = task.ground_count() + (targets.prize(targets.end()) > 0 ? 1 : 0);
  const Chains chains{
      .task = task, .targets = targets, .schedule = schedule, .bound = best.bound, .tell = [&](int visits) {
        if (std::this_thread::get_id() == caller) clock.tell({.visited = visited + visits, .bound = best.bound});
      }};
  std::vector<Plan> found(count);
  parallel_for(count, [&](int chain) {
    const Tour tour = chains.chain(start, derive_seed(options_.seed, static_cast<std::uint64_t>(chain)));
    found[chain] = plan_of_walk(task, walk_of(task, targets, tour.order));
  });
  const double bound = best.bound;
  for (Plan& plan : found) {
    if (plan.cost <= task.limit()) best = better_of(std::move(best), std::move(plan));
  }
  best.bound = bound;
  return best;
}

}  // namespace graphdrl
