#include "graphdrl/planners/annealing.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {
namespace {

// Chosen on validation worlds at a tenth of EA4OP's time (docs/search.md).
constexpr double kPrice = 0.6;  // of a share of the budget, in shares of the prize
constexpr double kFirstTemperature = 1;
constexpr double kLastTemperature = 0.08;
constexpr double kNoStringShare = 0.5;  // of steps that only turn a part of the route round
constexpr int kMostStrings = 2;
constexpr int kShort = 5;  // how long a string is at most, mostly
constexpr int kLong = 40;  // and sometimes: a branch of a maze or of a tree
constexpr double kLongShare = 0.06;
constexpr double kBlink = 0.03;     // of places passed over
constexpr int kTwoOptNear = 10;
constexpr int kTurnNear = 5;
constexpr int kTurnTries = 4;
constexpr int kLooks = 256;  // at most one copy of the best route in T / kLooks steps
constexpr double kRounding = 1e-9;
constexpr double kTiny = 1e-300;

}  // namespace

Annealing::Annealing(const Targets& targets, double limit, std::uint64_t seed)
    : targets_(&targets),
      limit_(limit),
      rng_(seed),
      route_(targets),
      unit_(targets.total_prize() / std::max(1, targets.end())),
      price_(0),
      marked_(targets.end() + 1),
      steps_per_look_(std::max(1, targets.end() / kLooks)) {}

void Annealing::start(const std::vector<int>& order, const std::vector<double>& links) {
  route_.assign(order, links);
  price_ = limit_ > 0 ? kPrice * route_.prize() / limit_ : 0;
  remember();
}

void Annealing::step(double progress) {
  const auto targets = static_cast<std::uint32_t>(targets_->end());
  const int seed = static_cast<int>(rng_.below(targets));
  ruin(seed);
  if (targets_->symmetric()) turn_near(seed);
  recreate(seed);
  if (targets_->symmetric()) improve();
  const double temperature = unit_ * kFirstTemperature * std::pow(kLastTemperature / kFirstTemperature, progress);
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
  best_ = route_.order();
  best_prize_ = route_.prize();
  best_cost_ = route_.cost();
}

bool Annealing::accept(double temperature) {
  const double gain = route_.prize() - route_.kept_prize() - price_ * (route_.cost() - route_.kept_cost());
  return gain >= 0 || rng_.uniform() < std::exp(gain / temperature);
}

// Takes out strings of targets that stand together and contain one near the seed.
void Annealing::ruin(int seed) {
  out_.clear();
  if (targets_->symmetric() && rng_.uniform() < kNoStringShare) return;
  int strings = 1 + static_cast<int>(rng_.below(kMostStrings));
  const std::uint32_t longest = rng_.uniform() < kLongShare ? kLong : kShort;
  const auto take_string = [&](int target) {
    if (target == 0 || !route_.contains(target)) return;
    const auto length = static_cast<int>(1 + rng_.below(longest));
    for (auto back = rng_.below(length); back > 0 && route_.previous(target) != 0; --back) {
      target = route_.previous(target);
    }
    for (int i = 0; i < length && target != targets_->end(); ++i) {
      const int next = route_.next(target);
      route_.remove(target);
      out_.push_back(target);
      target = next;
    }
    --strings;
  };
  take_string(seed);
  for (const int target : targets_->near(seed)) {
    if (strings == 0) break;
    take_string(target);
  }
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
    // Of the two ways on, or back, the ends change places.
    const int first = route_.before(target, other) ? target : other;
    const int second = first == target ? other : target;
    if (!forward && first == 0) continue;
    const int one = forward ? route_.next(first) : first;
    const int last = forward ? second : route_.previous(second);
    if (one == last) continue;
    const int before = route_.previous(one);
    const int after = route_.next(last);
    const double in = targets_->cost(before, last);
    const double out = targets_->cost(one, after);
    if (in + out - route_.link(before) - route_.link(last) > slack) continue;
    route_.reverse(one, last, in, out);
    for (const int touched : {before, one, last, after}) enqueue(touched);
    return;
  }
}

// Puts back what was taken out, and what is near, in random order.
void Annealing::recreate(int seed) {
  const std::size_t taken = out_.size();
  for (const int target : out_) marked_[target] = 1;
  const auto add = [&](int target) {
    if (!route_.contains(target) && marked_[target] == 0) out_.push_back(target);
  };
  add(seed);
  for (const int target : targets_->near(seed)) add(target);
  for (std::size_t i = 0; i < taken; ++i) marked_[out_[i]] = 0;
  for (std::size_t i = out_.size(); i > 1; --i) std::swap(out_[i - 1], out_[rng_.below(static_cast<std::uint32_t>(i))]);
  for (const int target : out_) put_back(target);
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
      if (route_.contains(near)) consider(near, targets_->cost(near, target), targets_->cost(target, route_.next(near)));
    }
    for (const int near : targets_->near(target)) {
      if (near == 0 || !route_.contains(near)) continue;
      const int before = route_.previous(near);
      consider(before, targets_->cost(before, target), targets_->cost(target, near));
    }
  }
  consider(last, targets_->cost(last, target), targets_->cost(target, targets_->end()));
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

// 2-opt [Croes 1958] from what changed, until nothing is left to gain there.
void Annealing::improve() {
  route_.changed([&](int target) {
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
      const bool in_order = route_.before(target, other);
      const int first = in_order ? target : other;
      const int second = in_order ? other : target;
      const int one = forward ? route_.next(first) : first;
      const int last = forward ? second : route_.previous(second);
      if (one == last) continue;
      const int before = route_.previous(one);
      const int after = route_.next(last);
      const double in = targets_->cost(before, last);
      const double out = targets_->cost(one, after);
      const double gain = route_.link(before) + route_.link(last) - in - out;
      if (gain <= kRounding * link) continue;
      route_.reverse(one, last, in, out);
      for (const int touched : {before, one, last, after}) enqueue(touched);
      return true;
    }
  }
  return false;
}

}  // namespace graphdrl
