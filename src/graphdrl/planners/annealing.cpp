#include "graphdrl/planners/annealing.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {

bool Annealing::is_selective(const Targets& targets, double prize, const AnnealingOptions& options) {
  return prize < (1 - options.selective_share) * targets.total_prize();
}

Annealing::Annealing(const Targets& targets, double limit, std::uint64_t seed, const AnnealingOptions& options)
    : draft_(targets, limit, seed, options),
      two_opt_(targets),
      steps_per_look_(std::max(1, targets.end() / options.looks)) {}

void Annealing::start(const std::vector<int>& order, const std::vector<double>& links) {
  Route& route = draft_.route;
  const int end = draft_.targets.end();
  route.assign(order, links);
  while (too_dear() && route.next(0) != end) route.remove(route.previous(end));
  route.keep();
  draft_.selective = is_selective(draft_.targets, route.prize(), draft_.options);
  remember();
}

void Annealing::recombine(const std::vector<int>& other) {
  cross_over(draft_, other);
  improve();
  if (too_dear()) draft_.route.undo();
  draft_.route.keep();
  best_prize_ = -1;
  remember();
}

void Annealing::step(double progress) {
  const AnnealingOptions::Style& style = draft_.style();
  const int seed = draft_.random_target();
  if (style.region_share > 0 && draft_.rng.uniform() < style.region_share) {
    const auto half = static_cast<int>(best_.size() / 2 + 1);
    move_region(draft_, seed, static_cast<std::uint32_t>(std::min(half, draft_.options.longest_moved)));
  } else {
    ruin(draft_, seed);
    if (draft_.targets.symmetric()) {
      if (const auto turn = Reversal::propose_near(draft_, seed)) two_opt_.apply(*turn, draft_);
    }
    recreate(draft_, seed);
  }
  improve();
  const double first = style.first_temperature;
  if (accept(draft_.mean_prize * first * std::pow(draft_.options.last_temperature / first, progress))) {
    draft_.route.keep();
  } else {
    draft_.route.undo();
  }
  if (++steps_ % steps_per_look_ == 0) remember();
}

const std::vector<int>& Annealing::best() {
  remember();
  return best_;
}

void Annealing::remember() {
  const Route& route = draft_.route;
  const double more = route.prize() - best_prize_;
  const double rounding = kCostRounding * draft_.mean_prize;
  if (more < -rounding || (more < rounding && route.cost() >= best_cost_ * (1 - kCostRounding))) return;
  best_.clear();
  best_links_.assign(1, route.link(0));
  for (int target = route.next(0); target != draft_.targets.end(); target = route.next(target)) {
    best_.push_back(target);
    best_links_.push_back(route.link(target));
  }
  best_prize_ = route.prize();
  best_cost_ = route.cost();
  if (draft_.limit > 0) price_ = draft_.options.price * best_prize_ / draft_.limit;
}

// Straight ways may cost more than those that they take the place of [Graph::complete()].
bool Annealing::too_dear() const {
  return !draft_.targets.metric() && draft_.route.cost() > draft_.limit;
}

bool Annealing::accept(double temperature) {
  if (too_dear()) return false;
  const Route& route = draft_.route;
  const double gain = route.prize() - route.kept_prize() - price_ * (route.cost() - route.kept_cost());
  return gain >= 0 || draft_.rng.uniform() < std::exp(gain / temperature);
}

void Annealing::improve() {
  if (draft_.targets.symmetric()) two_opt_.improve(draft_);
  if (!draft_.targets.has_table()) settle_links();
}

// Without a table, a link that a change left is known as an upper bound only. Searches for its cost.
void Annealing::settle_links() {
  const Targets& targets = draft_.targets;
  Route& route = draft_.route;
  loose_.clear();
  route.changed([&](int target, int other) {
    for (const int changed : {target, other}) {
      if (changed == Route::kNone || !route.contains(changed)) continue;
      loose_.push_back(changed);
      if (changed != 0) loose_.push_back(route.previous(changed));
    }
  });
  for (const int target : loose_) {
    const int next = route.next(target);
    if (targets.cost(target, next) != kNoLimit) continue;
    const double link = route.link(target);
    const double cost = targets.searched_cost(target, next, link, search_);
    if (cost < link) route.relink(target, cost);
  }
}

}  // namespace graphdrl
