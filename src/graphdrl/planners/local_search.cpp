#include "graphdrl/planners/local_search.h"

#include <algorithm>
#include <initializer_list>
#include <thread>

#include "graphdrl/base/parallel.h"
#include "graphdrl/planners/annealing.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/beam.h"
#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

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
    if (walk[i] == walk[i - 1]) continue;  // a blocked move
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

// When annealing ends: after a number of steps, at a deadline, or at what comes first.
class CoolingSchedule {
 public:
  // steps: 0 if the deadline alone counts.
  CoolingSchedule(std::int64_t steps, int steps_per_look, const Clock& clock)
      : steps_(steps), steps_per_look_(steps_per_look), clock_(clock), time_(clock.seconds_left()) {}

  // The share of the schedule that is over once `steps` were taken.
  double done(std::int64_t steps) const {
    double share = steps_ > 0 ? static_cast<double>(steps) / static_cast<double>(steps_) : 0;
    if (clock_.has_deadline()) share = std::max(share, time_ > 0 ? 1 - clock_.seconds_left() / time_ : 1);
    return clock_.stopped() ? 1 : share;
  }
  // How many steps to take then before the next look at the clock.
  int steps_to_look(std::int64_t steps) const {
    return steps_ == 0 ? steps_per_look_ : static_cast<int>(std::min<std::int64_t>(steps_per_look_, steps_ - steps));
  }

 private:
  std::int64_t steps_;
  int steps_per_look_;
  Clock clock_;
  double time_;  // seconds in all
};

// What the chains of one task share.
struct Chains {
  const LocalSearchOptions& options;
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
    Annealing annealing(targets, task.limit(), seed, options.annealing);
    annealing.start(start.order, start.links);
    return annealing;
  }

  // Where the choice matters, a population; else one run.
  Tour chain(const Tour& start, std::uint64_t seed) const {
    std::int64_t steps = 0;
    Annealing annealing = begin(start, derive_seed(seed, 0));
    if (!Annealing::is_selective(targets, start.prize, options.annealing)) {
      return run(annealing, {.first = 0, .last = 1}, steps);
    }
    const Tour best = best_of_population(start, seed, steps);
    annealing.start(best.order, best.links);
    const LocalSearchOptions::Population& population = options.population;
    return run(annealing, {.first = 1 - population.last_share, .last = 1, .progress = population.warm}, steps);
  }

  // Short runs, then children of any two: each takes the place of the worst route, if it is better and new.
  Tour best_of_population(const Tour& start, std::uint64_t seed, std::int64_t& steps) const {
    const auto& [size, first_share, children, last_share, warm] = options.population;
    std::vector<Tour> routes(size, start);
    for (int i = 0; i < size && schedule.done(steps) < first_share; ++i) {
      Annealing annealing = begin(start, derive_seed(seed, 1, static_cast<std::uint64_t>(i)));
      const double first = first_share * i / size;
      routes[i] = run(annealing, {.first = first, .last = first + first_share / size}, steps);
    }
    const auto by_prize = [](const Tour& a, const Tour& b) { return a.prize < b.prize; };
    Rng rng(derive_seed(seed, 2));
    const auto parents = static_cast<std::uint32_t>(size);
    const double share = (1 - first_share - last_share) / children;
    for (int i = 0; i < children; ++i) {
      const double first = first_share + share * i;
      if (schedule.done(steps) >= first + share) continue;
      const auto one = rng.below(parents);
      const auto other = (one + 1 + rng.below(parents - 1)) % parents;
      Annealing annealing = begin(routes[one], derive_seed(seed, 3, static_cast<std::uint64_t>(i)));
      annealing.recombine(routes[other].order);
      Tour child = run(annealing, {.first = first, .last = first + share, .progress = warm}, steps);
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

std::int64_t default_steps(std::int64_t targets, const LocalSearchOptions& options) {
  const double largeness = std::max(1.0, static_cast<double>(targets) / options.large_targets);
  const auto most = static_cast<std::int64_t>(options.large_steps / (largeness * largeness));
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
  const Targets targets(task, clock.share(options_.targets_share));
  best.bound = std::min(max_prize(task, clock.share(options_.bound_share)), targets.total_prize());
  std::unique_ptr<LpBound> lp;
  if (!meets(best.prize, best.bound) && !clock.passed()) lp = make_lp_bound(task, best.bound);
  if (lp != nullptr) {
    const double work = clock.has_deadline() ? kNoLimit : options_.root_work;
    lp->cut(best.prize, {.clock = clock.share(options_.bound_share), .work = work});
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
  std::int64_t steps = default_steps(targets.end(), options_);
  if (!clock.has_deadline() || options_.iterations > 0) {
    search_for(options_.iterations > 0 ? options_.iterations : steps);
    branch({.clock = clock, .work = options_.branch_work});
  } else {
    // Searches and branches in turn, each time twice as long, while time is left for more than the next turn. The last
    // search has the rest.
    while (lp != nullptr && !meets(best.prize, best.bound) &&
           clock.seconds_left() > options_.branch_from * options_.step_s * static_cast<double>(steps)) {
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
    const Clock until = clock.share(options_.start_share);
    if (planner == explorer_.get() && options_.explorer_visit_s * targets.end() > until.seconds_left()) continue;
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
  clock = clock.sooner(options_.walk_times * watch.seconds());
  const int count = clock.has_deadline() ? threads() : options_.chains;
  const CoolingSchedule schedule((steps + count - 1) / count, options_.steps_per_look, clock);
  const auto caller = std::this_thread::get_id();
  const int visited = task.ground_count() + (targets.prize(targets.end()) > 0 ? 1 : 0);
  const auto tell = [&](int visits) {
    if (std::this_thread::get_id() == caller) clock.tell({.visited = visited + visits, .bound = best.bound});
  };
  const Chains chains{options_, task, targets, schedule, best.bound, tell};
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
