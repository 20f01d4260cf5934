#include "graphdrl/planners/local_search.h"

#include <algorithm>
#include <initializer_list>
#include <thread>

#include "graphdrl/base/parallel.h"
#include "graphdrl/planners/annealing.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/planners/covering_walk.h"
#include "graphdrl/planners/parts.h"

namespace graphdrl {
namespace {

// All numbers are those by which most is visited on worlds of the validation split (docs/search.md).

// Where the choice of targets matters [Annealing::is_selective()], a chain keeps a population of routes.
constexpr int kPopulation = 8;
constexpr double kFirstShare = 0.4;  // of the schedule, for the first routes
constexpr int kChildren = 64;        // each of two routes
constexpr double kLastShare = 0.1;   // of the schedule, for the last run, from the best route
constexpr double kWarm = 0.6;        // of the way from the first temperature to the last, where children begin

// With a deadline: shares of the time left.
constexpr double kTargetsShare = 0.5;  // for the costs between targets, at most
constexpr double kBoundShare = 0.05;   // for the knapsack bound, and again for the root of the linear program
constexpr double kStartShare = 0.05;   // for each walk to start with but nearest
// Without a deadline: LpBound::Effort::work.
constexpr double kRootWork = 1e7;    // at most about 0.3 s
constexpr double kBranchWork = 2e6;  // once the search is over

constexpr double kExplorerVisitS = 0.4e-3;  // a first visit: the explorer is not begun where it would not end
constexpr double kStepS = 5e-6;             // a step, about
constexpr double kBranchFrom = 4;    // branch only if the time left is over this many searches; it then gets one's time
constexpr double kWalkTimes = 2;     // time kept for the last walk, in times that the walk of the start takes
constexpr int kChains = 2;           // without a deadline, so that the walk does not depend on the number of threads
constexpr int kStepsPerLook = 16;    // at the clock
constexpr int kPartsFrom = 5000;     // nodes in reach: walks over more are first improved by parts
constexpr int kWholeUntil = 20'000;  // beyond, the whole is annealed only once parts do no better
constexpr double kPartsShare = 0.5;  // of the time left, up to there
constexpr std::int64_t kPartsSteps = 1'000'000;  // without a deadline
// At most kLargeSteps up to kLargeTargets targets, and fewer by the square of their number beyond: steps take longer.
constexpr double kLargeSteps = 1e6;
constexpr double kLargeTargets = 1e4;

// The chains of one task, and when they end: after a number of steps, at a deadline, or at what comes first.
struct Chains {
  const Task& task;
  const Targets& targets;
  double bound;
  std::function<void(int visits)> tell;
  std::int64_t most_steps;  // 0 if the deadline alone counts
  Clock clock;
  double seconds = clock.seconds_left();  // in all

  // The share of the schedule that is over once a chain took so many steps.
  double done(std::int64_t steps) const {
    double share = most_steps > 0 ? static_cast<double>(steps) / static_cast<double>(most_steps) : 0;
    if (clock.has_deadline()) share = std::max(share, seconds > 0 ? 1 - clock.seconds_left() / seconds : 1);
    return clock.stopped() ? 1 : share;
  }
  // How many to take then before the next look at the clock.
  int steps_to_look(std::int64_t steps) const {
    return most_steps == 0 ? kStepsPerLook
                           : static_cast<int>(std::min<std::int64_t>(kStepsPerLook, most_steps - steps));
  }

  // A part of the schedule, and how far annealing is where it begins.
  struct Part {
    double first;
    double last;
    double progress = 0;
  };

  // One run. steps: taken by the chain up to now.
  Tour run(Annealing& annealing, const Part& part, std::int64_t& steps) const {
    const auto ends = [&] { return meets(annealing.best_seen().prize, bound); };
    for (double now = done(steps); now < part.last && !ends(); now = done(steps)) {
      const double share = std::clamp((now - part.first) / (part.last - part.first), 0.0, 1.0);
      const double progress = part.progress + (1 - part.progress) * share;
      const int count = steps_to_look(steps);
      for (int i = 0; i < count && !ends(); ++i) annealing.step(progress);
      steps += count;
      tell(static_cast<int>(annealing.best_seen().order.size()));
    }
    return annealing.best();
  }

  // Where the choice matters, a population; else one run.
  Tour chain(const Tour& start, std::uint64_t seed) const {
    std::int64_t steps = 0;
    Annealing annealing(targets, task.limit(), derive_seed(seed, 0), start);
    if (!Annealing::is_selective(targets, start.prize)) return run(annealing, {.first = 0, .last = 1}, steps);
    annealing.start(best_of_population(start, seed, steps));
    return run(annealing, {.first = 1 - kLastShare, .last = 1, .progress = kWarm}, steps);
  }

  // Short runs, then children of any two: each takes the place of the worst route, if it is better and new.
  Tour best_of_population(const Tour& start, std::uint64_t seed, std::int64_t& steps) const {
    std::vector<Tour> routes(kPopulation, start);
    for (int i = 0; i < kPopulation && done(steps) < kFirstShare; ++i) {
      Annealing annealing(targets, task.limit(), derive_seed(seed, 1, static_cast<std::uint64_t>(i)), start);
      const double first = kFirstShare * i / kPopulation;
      routes[i] = run(annealing, {.first = first, .last = first + kFirstShare / kPopulation}, steps);
    }
    const auto by_prize = [](const Tour& a, const Tour& b) { return a.prize < b.prize; };
    Rng rng(derive_seed(seed, 2));
    const double share = (1 - kFirstShare - kLastShare) / kChildren;
    for (int i = 0; i < kChildren; ++i) {
      const double first = kFirstShare + share * i;
      if (done(steps) >= first + share) continue;
      const auto one = rng.below(kPopulation);
      const auto other = (one + 1 + rng.below(kPopulation - 1)) % kPopulation;
      Annealing annealing(targets, task.limit(), derive_seed(seed, 3, static_cast<std::uint64_t>(i)), routes[one]);
      annealing.recombine(routes[other].order);
      Tour child = run(annealing, {.first = first, .last = first + share, .progress = kWarm}, steps);
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

std::int64_t default_steps(std::int64_t targets) {
  const double largeness = std::max(1.0, static_cast<double>(targets) / kLargeTargets);
  const auto most = static_cast<std::int64_t>(kLargeSteps / (largeness * largeness));
  const std::int64_t usual = std::min(3 * targets * targets, std::max<std::int64_t>(550'000, 100 * targets));
  return std::max<std::int64_t>(std::min(usual, most), 10'000);
}

}  // namespace

Plan LocalSearchPlanner::plan(const Task& task, const Clock& clock) {
  return search(task, NearestPlanner().plan(task, clock), clock);
}

Plan LocalSearchPlanner::plan_from(const Task& task, Plan known, const Clock& clock) {
  known.bound = kNoLimit;
  return search(task, better_of(std::move(known), NearestPlanner().plan(task, clock)), clock);
}

// best: the best walk up to now.
Plan LocalSearchPlanner::search(const Task& task, Plan best, const Clock& clock) {
  if (std::ssize(task.reach().nodes) > kPartsFrom && !task.view().open().is_complete()) {
    return search_by_parts(task, std::move(best), clock);
  }
  const Targets targets(task, clock.share(kTargetsShare));
  best.bound = std::min(max_prize(task, clock.share(kBoundShare)), targets.total_prize());
  std::unique_ptr<LpBound> lp;
  if (!meets(best.prize, best.bound) && !clock.passed()) lp = make_lp_bound(task, best.bound);
  if (lp != nullptr) {
    const double work = clock.has_deadline() ? kNoLimit : kRootWork;
    lp->cut(best.prize, {.clock = clock.share(kBoundShare), .work = work});
    best.bound = std::min(best.bound, lp->bound());
  }
  best = best_start(task, std::move(best), clock);
  const auto search_for = [&](std::int64_t steps) {
    if (meets(best.prize, best.bound) || !targets.complete() || targets.end() <= 1 || clock.passed()) return;
    best = anneal(task, targets, std::move(best), steps, clock);
  };
  const auto branch = [&](const LpBound::Effort& effort) {
    if (lp == nullptr || meets(best.prize, best.bound)) return;
    lp->branch(best.prize, effort);
    improve(*lp, task, best);
  };
  std::int64_t steps = default_steps(targets.end());
  if (!clock.has_deadline() || iterations_ > 0) {
    search_for(iterations_ > 0 ? iterations_ : steps);
    branch({.clock = clock, .work = kBranchWork});
  } else {
    // Searches and branches in turn, each time twice as long, while time is left for more than the next turn. The last
    // search has the rest.
    while (lp != nullptr && !meets(best.prize, best.bound) &&
           clock.seconds_left() > kBranchFrom * kStepS * static_cast<double>(steps)) {
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

Plan LocalSearchPlanner::search_by_parts(const Task& task, Plan best, const Clock& clock) {
  const auto nodes = std::ssize(task.reach().nodes);
  const bool small = nodes <= kWholeUntil;
  const double bound = max_prize(task, clock.share(kBoundShare));
  best.bound = bound;
  best = best_start(task, std::move(best), clock);
  std::int64_t steps = 0;
  if (iterations_ > 0 || !clock.has_deadline()) steps = iterations_ > 0 ? iterations_ : kPartsSteps;
  best = improve_by_parts(task, std::move(best), steps, seed_, small ? clock.share(kPartsShare) : clock);
  const bool has_time = iterations_ == 0 && !clock.passed() && (small || clock.has_deadline());
  if (has_time && !meets(best.prize, bound)) {
    const Targets targets(task, clock.share(kTargetsShare));
    steps = clock.has_deadline() ? 0 : default_steps(targets.end());
    if (targets.complete() && targets.end() > 1) best = anneal(task, targets, std::move(best), steps, clock);
  }
  best.settle(bound);
  return best;
}

// The best of all walks to begin with.
Plan LocalSearchPlanner::best_start(const Task& task, Plan best, const Clock& clock) {
  const double bound = best.bound;
  const auto nodes = static_cast<double>(task.reach().nodes.size());
  if (nodes > Targets::kTableTargets && covering_fits(task)) {
    best = better_of(std::move(best), covering_plan(task, clock));
  }
  DepthFirstPlanner depth_first;
  BeamPlanner beam{BeamOptions()};
  for (Planner* const planner : std::initializer_list<Planner*>{&depth_first, &beam, explorer_.get()}) {
    if (meets(best.prize, bound) || clock.passed()) break;
    if (planner != &depth_first && !clock.has_deadline() && nodes > kWholeUntil) continue;  // they take minutes
    if (planner == &beam && !beam_fits(task.view(), BeamOptions())) continue;
    const Clock until = clock.share(kStartShare);
    if (planner == explorer_.get() && kExplorerVisitS * nodes > until.seconds_left()) continue;
    best = better_of(std::move(best), planner->plan(task, until));
    if (best.optimal) break;
  }
  best.bound = best.optimal ? best.prize : bound;
  return best;
}

// steps: 0 to go on until the clock passes.
Plan LocalSearchPlanner::anneal(const Task& task, const Targets& targets, Plan best, std::int64_t steps, Clock clock) {
  const Tour start = tour_of(task, targets, best);
  // What comes after the last step takes about as long as this.
  const Stopwatch watch;
  walk_of(task, targets, start.order);
  clock = clock.sooner(kWalkTimes * watch.seconds());
  const int count = clock.has_deadline() ? threads() : kChains;
  const auto caller = std::this_thread::get_id();
  const int visited = task.ground_count() + (targets.prize(targets.end()) > 0 ? 1 : 0);
  const auto tell = [&](int visits) {
    if (std::this_thread::get_id() == caller) clock.tell({.visited = visited + visits, .bound = best.bound});
  };
  const Chains chains{.task = task,
                      .targets = targets,
                      .bound = best.bound,
                      .tell = tell,
                      .most_steps = (steps + count - 1) / count,
                      .clock = clock};
  std::vector<Plan> found(count);
  parallel_for(count, [&](int chain) {
    const Tour tour = chains.chain(start, derive_seed(seed_, static_cast<std::uint64_t>(chain)));
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
