#include "graphdrl/planners/annealing.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {
namespace {

constexpr double kSelectiveShare = 0.3;    // of the prize: a start that leaves out more is selective
constexpr double kLastTemperature = 0.08;  // in mean prizes
constexpr double kPrice = 0.6;  // worth of the whole budget, in prizes of the best route: cheaper routes are better
constexpr int kLongestMoved = 2000;  // targets of a region that moves: half of a route in worlds of up to 60x60
constexpr int kLooks = 256;  // the best route is copied at most every T / kLooks steps of T targets: a copy costs T

}  // namespace

bool Annealing::is_selective(const Targets& targets, double prize) {
  return prize < (1 - kSelectiveShare) * targets.total_prize();
}

Annealing::Annealing(const Targets& targets, double limit, std::uint64_t seed, const Tour& start, double price)
    : draft_(targets, limit, seed),
      two_opt_(targets),
      elsewhere_(price),
      steps_per_look_(std::max(1, targets.end() / kLooks)) {
  this->start(start);
}

void Annealing::start(const Tour& tour) {
  Route& route = draft_.route;
  const int end = draft_.targets.end();
  route.assign(tour.order, tour.links);
  while (too_dear() && route.next(0) != end) route.remove(route.previous(end));
  route.keep();
  draft_.selective = is_selective(draft_.targets, route.prize());
  remember();
}

void Annealing::recombine(const std::vector<int>& other) {
  cross_over(draft_, other);
  improve();
  if (too_dear()) draft_.route.undo();
  draft_.route.keep();
  best_.prize = -kNoLimit;
  remember();
}

void Annealing::step(double progress) {
  const Style& style = draft_.style();
  const int seed = draft_.random_target();
  if (style.region_share > 0 && draft_.rng.uniform() < style.region_share) {
    const auto half = static_cast<int>(best_.order.size() / 2 + 1);
    move_region(draft_, seed, static_cast<std::uint32_t>(std::min(half, kLongestMoved)));
  } else {
    ruin(draft_, seed);
    if (draft_.targets.symmetric()) {
      if (const auto turn = Reversal::propose_near(draft_, seed)) two_opt_.apply(*turn, draft_);
    }
    recreate(draft_, seed);
  }
  improve();
  const double first = style.first_temperature;
  if (accept(draft_.mean_prize * first * std::pow(kLastTemperature / first, progress))) {
    draft_.route.keep();
  } else {
    draft_.route.undo();
  }
  if (++steps_ % steps_per_look_ == 0) remember();
}

const Tour& Annealing::best() {
  remember();
  return best_;
}

void Annealing::remember() {
  const Route& route = draft_.route;
  const double more = route.prize() - best_.prize - elsewhere_ * (route.cost() - best_.cost);
  const double rounding = kCostRounding * draft_.mean_prize;
  if (more < -rounding || (more < rounding && route.cost() >= best_.cost * (1 - kCostRounding))) return;
  best_.order.clear();
  best_.links.assign(1, route.link(0));
  for (int target = route.next(0); target != draft_.targets.end(); target = route.next(target)) {
    best_.order.push_back(target);
    best_.links.push_back(route.link(target));
  }
  best_.prize = route.prize();
  best_.cost = route.cost();
  if (elsewhere_ > 0) {
    price_ = elsewhere_;
  } else if (draft_.limit > 0) {
    price_ = kPrice * best_.prize / draft_.limit;
  }
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
