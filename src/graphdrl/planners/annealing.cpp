#include "graphdrl/planners/annealing.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {
namespace {

// Chosen on validation worlds at a tenth of EA4OP's time (docs/search.md).
constexpr double kPrice = 0.6;  // of a share of the budget, in shares of the prize
constexpr double kLastTemperature = 0.08;
constexpr int kMostStrings = 2;
constexpr int kShort = 5;        // how long a string is at most, mostly
constexpr int kLong = 40;        // and sometimes: a branch of a maze or of a tree
constexpr double kBlink = 0.03;  // of places passed over
constexpr int kTwoOptNear = 10;
constexpr int kTurnNear = 5;
constexpr int kTurnTries = 4;
constexpr int kLooks = 256;       // at most one copy of the best route in T / kLooks steps
constexpr int kGrownNear = 10;    // of a target that a region grows from
constexpr int kMostFailures = 5;  // to put a target into a region, and it grows no more
constexpr int kSeedTries = 20;
constexpr double kLeastRegion = 0.1;  // of all targets, taken from another route
constexpr double kMostRegion = 0.5;
constexpr std::size_t kLongestMoved = 2000;  // targets, likewise: half of a route in worlds of up to 60x60
constexpr double kLargestRegion = 1000;      // targets: more would take longer than a look at the clock may wait
constexpr double kRounding = 1e-9;
constexpr double kTiny = 1e-300;

constexpr double kSelectiveShare = 0.3;  // of the prize left out at the start, from which on the choice counts

bool have_equal_prizes(const Targets& targets) {
  for (int target = 2; target < targets.end(); ++target) {
    if (targets.prize(target) != targets.prize(1)) return false;
  }
  return true;
}

}  // namespace

constexpr Annealing::Style Annealing::kOrdering = {
    .first_temperature = 1, .no_string_share = 0.5, .long_share = 0.06, .elsewhere_share = 0, .region_share = 0};
constexpr Annealing::Style Annealing::kSelective = {
    .first_temperature = 3, .no_string_share = 0.3, .long_share = 0.15, .elsewhere_share = 0.3, .region_share = 0.1};

bool Annealing::is_selective(const Targets& targets, double prize) {
  return prize < (1 - kSelectiveShare) * targets.total_prize();
}

Annealing::Annealing(const Targets& targets, double limit, std::uint64_t seed)
    : targets_(&targets),
      limit_(limit),
      rng_(seed),
      style_(kOrdering),
      route_(targets),
      unit_(targets.total_prize() / std::max(1, targets.end())),
      equal_prizes_(have_equal_prizes(targets)),
      price_(0),
      marked_(targets.end() + 1),
      steps_per_look_(std::max(1, targets.end() / kLooks)) {}

void Annealing::start(const std::vector<int>& order, const std::vector<double>& links) {
  route_.assign(order, links);
  while (too_dear() && route_.next(0) != targets_->end()) route_.remove(route_.previous(targets_->end()));
  route_.keep();
  style_ = is_selective(*targets_, route_.prize()) ? kSelective : kOrdering;
  remember();
}

void Annealing::recombine(const std::vector<int>& other) {
  const int targets = targets_->end();
  const double share = kLeastRegion + (kMostRegion - kLeastRegion) * rng_.uniform();
  const auto size = static_cast<std::size_t>(std::clamp(share * targets, 1.0, kLargestRegion));
  grown_.assign(1, static_cast<int>(rng_.below(static_cast<std::uint32_t>(targets))));
  marked_[grown_[0]] = 1;
  for (std::size_t i = 0; i < grown_.size() && grown_.size() < size; ++i) {
    for (const int near : targets_->near(grown_[i])) {
      if (marked_[near] != 0 || grown_.size() == size) continue;
      marked_[near] = 1;
      grown_.push_back(near);
    }
  }
  removed_.clear();
  for (const int target : grown_) {
    if (target == 0 || !route_.contains(target)) continue;
    route_.remove(target);
    removed_.push_back(target);
  }
  for (const int target : other) {
    if (marked_[target] != 0 && !route_.contains(target)) put_back(target);
  }
  for (const int target : grown_) marked_[target] = 0;
  put_back_removed();
  if (targets_->symmetric()) improve();
  if (!targets_->has_table()) settle_links();
  if (too_dear()) route_.undo();
  route_.keep();
  best_prize_ = -1;
  remember();
}

void Annealing::step(double progress) {
  const auto targets = static_cast<std::uint32_t>(targets_->end());
  const int seed = static_cast<int>(rng_.below(targets));
  if (style_.region_share > 0 && rng_.uniform() < style_.region_share) {
    move_region(seed);
  } else {
    ruin(seed);
    if (targets_->symmetric()) turn_near(seed);
    recreate(seed);
  }
  if (targets_->symmetric()) improve();
  if (!targets_->has_table()) settle_links();
  const double temperature =
      unit_ * style_.first_temperature * std::pow(kLastTemperature / style_.first_temperature, progress);
  if (accept(temperature)) {
    route_.keep();
  } else {
    route_.undo();
  }
  if (++steps_ % steps_per_look_ == 0) remember();
}

const std::vector<int>& Annealing::best() {
  remember();
  return best_;
}

void Annealing::remember() {
  const double more = route_.prize() - best_prize_;
  if (more < -kRounding * unit_) return;
  if (more < kRounding * unit_ && route_.cost() >= best_cost_ * (1 - kRounding)) return;
  best_.clear();
  best_links_.assign(1, route_.link(0));
  for (int target = route_.next(0); target != targets_->end(); target = route_.next(target)) {
    best_.push_back(target);
    best_links_.push_back(route_.link(target));
  }
  best_prize_ = route_.prize();
  best_cost_ = route_.cost();
  if (limit_ > 0) price_ = kPrice * best_prize_ / limit_;
}

// Straight ways may cost more than those that they take the place of [Graph::complete()].
bool Annealing::too_dear() const {
  return !targets_->metric() && route_.cost() > limit_;
}

bool Annealing::accept(double temperature) {
  if (too_dear()) return false;
  const double gain = route_.prize() - route_.kept_prize() - price_ * (route_.cost() - route_.kept_cost());
  return gain >= 0 || rng_.uniform() < std::exp(gain / temperature);
}

// Takes out strings of targets that stand together and contain one near the seed.
void Annealing::ruin(int seed) {
  removed_.clear();
  if (targets_->symmetric() && rng_.uniform() < style_.no_string_share) return;
  int strings = 1 + static_cast<int>(rng_.below(kMostStrings));
  const std::uint32_t longest = rng_.uniform() < style_.long_share ? kLong : kShort;
  const auto take_one = [&](int target) {
    if (target == 0 || !route_.contains(target)) return;
    const auto length = static_cast<int>(1 + rng_.below(longest));
    for (auto back = rng_.below(length); back > 0 && route_.previous(target) != 0; --back) {
      target = route_.previous(target);
    }
    take_string(target, length);
    --strings;
  };
  take_one(seed);
  for (const int target : targets_->near(seed)) {
    if (strings == 0) break;
    take_one(target);
  }
}

void Annealing::take_string(int first, int length) {
  for (int target = first; length > 0 && target != targets_->end(); --length) {
    const int next = route_.next(target);
    route_.remove(target);
    removed_.push_back(target);
    target = next;
  }
}

// Takes up to half of the route out, lets what is left of the budget grow a region around a target that is not in it,
// and puts back what still fits.
void Annealing::move_region(int seed) {
  removed_.clear();
  const auto targets = static_cast<std::uint32_t>(targets_->end());
  for (int i = 0; i < kSeedTries && route_.contains(seed); ++i) seed = static_cast<int>(rng_.below(targets));
  int first = 0;
  for (int i = 0; i < kSeedTries && (first == 0 || !route_.contains(first)); ++i) {
    first = static_cast<int>(rng_.below(targets));
  }
  const auto half = static_cast<std::uint32_t>(std::min(best_.size() / 2 + 1, kLongestMoved));
  if (first != 0 && route_.contains(first)) take_string(first, static_cast<int>(1 + rng_.below(half)));

  grown_.assign(1, seed);
  int failures = 0;
  for (std::size_t i = 0; i < grown_.size() && failures < kMostFailures; ++i) {
    const int target = grown_[i];
    if (!route_.contains(target)) put_back(target);
    if (!route_.contains(target)) {
      ++failures;
      continue;
    }
    const auto near = targets_->near(target);
    for (const int next : near.first(std::min<std::size_t>(kGrownNear, near.size()))) {
      if (marked_[next] != 0 || route_.contains(next)) continue;
      marked_[next] = 1;
      grown_.push_back(next);
    }
  }
  for (const int target : grown_) marked_[target] = 0;
  put_back_removed();
}

// The ways on from two targets, or the ways to them, change their ends.
Annealing::Turn Annealing::turn_of(int target, int other, bool forward) const {
  const bool in_order = route_.before(target, other);
  const int early = in_order ? target : other;
  const int late = in_order ? other : target;
  const int first = forward ? route_.next(early) : early;
  const int last = forward ? late : route_.previous(late);
  const int before = route_.previous(first);
  const double in = targets_->cost(before, last);
  const double out = targets_->cost(first, route_.next(last));
  return {
      .first = first, .last = last, .in = in, .out = out, .added = in + out - route_.link(before) - route_.link(last)};
}

void Annealing::turn(const Turn& turn) {
  const int before = route_.previous(turn.first);
  const int after = route_.next(turn.last);
  route_.reverse(turn.first, turn.last, turn.in, turn.out);
  for (const int touched : {before, turn.first, turn.last, after}) enqueue(touched);
}

// A random 2-opt move near a target, if it can be paid for.
void Annealing::turn_near(int target) {
  const auto near_target = targets_->near(target);
  if (!route_.contains(target)) {
    const auto found =
        std::find_if(near_target.begin(), near_target.end(), [&](int near) { return route_.contains(near); });
    if (found == near_target.end()) return;
    target = *found;
  }
  const auto near = targets_->near(target).first(std::min<std::size_t>(kTurnNear, targets_->near(target).size()));
  if (near.empty()) return;
  const double slack = limit_ - route_.cost();
  for (int i = 0; i < kTurnTries; ++i) {
    const int other = near[rng_.below(static_cast<std::uint32_t>(near.size()))];
    const bool forward = (rng_.next() >> 63) != 0;
    if (!route_.contains(other)) continue;
    if (!forward && (target == 0 || other == 0)) continue;
    const Turn found = turn_of(target, other, forward);
    if (found.first == found.last || found.added > slack) continue;
    turn(found);
    return;
  }
}

// Puts back what was taken out, and what is near.
void Annealing::recreate(int seed) {
  const std::size_t taken = removed_.size();
  for (const int target : removed_) marked_[target] = 1;
  const auto add = [&](int target) {
    if (!route_.contains(target) && marked_[target] == 0) removed_.push_back(target);
  };
  add(seed);
  for (const int target : targets_->near(seed)) add(target);
  for (std::size_t i = 0; i < taken; ++i) marked_[removed_[i]] = 0;
  if (style_.elsewhere_share > 0 && rng_.uniform() < style_.elsewhere_share) {
    // What was given up here may pay elsewhere.
    const auto other = static_cast<int>(rng_.below(static_cast<std::uint32_t>(targets_->end())));
    if (!route_.contains(other)) put_back(other);
    for (const int target : targets_->near(other)) {
      if (!route_.contains(target)) put_back(target);
    }
  }
  put_back_removed();
}

void Annealing::put_back_removed() {
  put_in_random_order(removed_);
  for (const int target : removed_) {
    if (!route_.contains(target)) put_back(target);
  }
}

// Which is next has a probability in proportion to the square of its prize [Efraimidis and Spirakis 2006].
void Annealing::put_in_random_order(std::vector<int>& targets) {
  if (equal_prizes_) {
    for (std::size_t i = targets.size(); i > 1; --i) {
      std::swap(targets[i - 1], targets[rng_.below(static_cast<std::uint32_t>(i))]);
    }
    return;
  }
  keyed_.clear();
  for (const int target : targets) {
    const double prize = targets_->prize(target) / unit_;
    keyed_.emplace_back(-std::log(rng_.uniform()) / (prize * prize), target);
  }
  std::sort(keyed_.begin(), keyed_.end());
  for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = keyed_[i].second;
}

// The cheapest place for a target that can be paid for; after == kNone where there is none.
Annealing::Place Annealing::cheapest_place(int target) {
  Place best{.after = kNone, .added = (limit_ - route_.cost()) * (1 + kRounding) + kTiny};
  const auto consider = [&](int after, double in, double out) {
    const double added = in + out - route_.link(after);
    if (added >= best.added || rng_.next() < static_cast<std::uint64_t>(kBlink * 0x1p64)) return;
    best = {.after = after, .added = added, .in = in, .out = out};
  };
  const int last = route_.previous(targets_->end());
  if (targets_->symmetric()) {
    // The nearest come first. Of two neighbours in the route the nearer one comes first, so by a later one the way
    // there and back is the least that a place costs, less the way that it saves.
    for (const int near : targets_->near(target)) {
      if (!route_.contains(near)) continue;
      const double there = targets_->cost(target, near);
      const double there_and_back = there + there;
      if (const double link = route_.link(near); there_and_back - link < best.added && near != last) {
        const double out = targets_->cost(target, route_.next(near));
        consider(near, there, out == kNoLimit ? there + link : out);
      }
      if (near == 0) continue;
      const int before = route_.previous(near);
      if (const double link = route_.link(before); there_and_back - link < best.added) {
        const double in = targets_->cost(target, before);
        consider(before, in == kNoLimit ? link + there : in, there);
      }
      if (best.added <= 0) break;
    }
  } else {
    for (const int near : targets_->into(target)) {
      if (route_.contains(near))
        consider(near, targets_->cost(near, target), targets_->cost(target, route_.next(near)));
    }
    for (const int near : targets_->near(target)) {
      if (near == 0 || !route_.contains(near)) continue;
      const int before = route_.previous(near);
      consider(before, targets_->cost(before, target), targets_->cost(target, near));
    }
  }
  consider(last, targets_->cost(last, target), targets_->cost(target, targets_->end()));
  if (style_.region_share == 0 || best.after != kNone || !targets_->has_table()) return best;
  // Where nothing near is in the route, a region begins here.
  const auto near = targets_->near(target);
  if (std::any_of(near.begin(), near.end(), [&](int one) { return route_.contains(one); })) return best;
  for (int at = 0; at != last; at = route_.next(at)) {
    consider(at, targets_->cost(at, target), targets_->cost(target, route_.next(at)));
  }
  return best;
}

void Annealing::put_back(int target) {
  const Place place = cheapest_place(target);
  if (place.after == kNone || route_.cost() + place.added > limit_) return;
  route_.insert(target, place.after, place.in, place.out);
}

void Annealing::enqueue(int target) {
  if (target == targets_->end() || marked_[target] != 0) return;
  marked_[target] = 1;
  queue_.push_back(target);
}

// Without a table, what a way costs that a change left is known at most. Here it is searched for.
void Annealing::settle_links() {
  loose_.clear();
  route_.changed([&](int target, int other) {
    for (const int changed : {target, other}) {
      if (changed == kNone || !route_.contains(changed)) continue;
      loose_.push_back(changed);
      if (changed != 0) loose_.push_back(route_.previous(changed));
    }
  });
  for (const int target : loose_) {
    const int next = route_.next(target);
    if (targets_->cost(target, next) != kNoLimit) continue;
    const double link = route_.link(target);
    const double cost = targets_->searched_cost(target, next, link, search_);
    if (cost < link) route_.relink(target, cost);
  }
}

// 2-opt [Croes 1958] from what changed, until nothing is left to gain there.
void Annealing::improve() {
  route_.changed([&](int target, int /*other*/) {
    if (!route_.contains(target)) return;
    enqueue(target);
    if (target != 0) enqueue(route_.previous(target));
    enqueue(route_.next(target));
  });
  while (!queue_.empty()) {
    const int target = queue_.back();
    queue_.pop_back();
    marked_[target] = 0;
    while (route_.contains(target) && two_opt(target)) {
    }
  }
}

// Replaces the way on from a target, or the way to it, by one to a nearer target, where that makes the route cheaper.
bool Annealing::two_opt(int target) {
  auto near = targets_->near(target);
  near = near.first(std::min<std::size_t>(kTwoOptNear, near.size()));
  for (const bool forward : {true, false}) {
    if (!forward && target == 0) continue;
    const double link = route_.link(forward ? target : route_.previous(target));
    for (const int other : near) {
      if (targets_->cost(target, other) >= link) break;
      if (!route_.contains(other) || (!forward && other == 0)) continue;
      const Turn found = turn_of(target, other, forward);
      if (found.first == found.last) continue;
      const double links = route_.link(route_.previous(found.first)) + route_.link(found.last);
      if (found.added >= -kRounding * links) continue;
      turn(found);
      return true;
    }
  }
  return false;
}

}  // namespace graphdrl
