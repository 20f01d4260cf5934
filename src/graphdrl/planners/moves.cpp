#include "graphdrl/planners/moves.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace graphdrl {
namespace {

constexpr double kTiny = 1e-300;  // a place that costs nothing can be paid for when nothing is left

constexpr std::uint32_t kMostStrings = 2;  // taken out in a step
constexpr std::uint32_t kShortString = 5;  // targets at most, in most steps
constexpr std::uint32_t kLongString = 40;  // targets at most, in the others: a branch of a maze or of a tree
constexpr double kBlink = 0.03;   // share of places passed over, so that the same targets go to different places
constexpr int kTwoOptNear = 10;   // nearest targets that 2-opt tries
constexpr int kTurnNear = 5;      // nearest targets that a random turn draws from
constexpr int kTurnTries = 4;     // draws until one can be paid for
constexpr int kGrowNear = 10;     // nearest targets by which a region grows from each of its own
constexpr int kGrowFailures = 5;  // targets that do not fit, until a region grows no more
constexpr int kSeedTries = 20;    // draws of a target that is in the route, or is not

constexpr double kLeastRegion = 0.1;  // of all targets, taken from the other route of two
constexpr double kMostRegion = 0.5;
constexpr double kLargestRegion = 1000;  // targets, likewise: more take longer than a look at the clock may wait

bool have_equal_prizes(const Targets& targets) {
  for (int target = 2; target < targets.end(); ++target) {
    if (targets.prize(target) != targets.prize(1)) return false;
  }
  return true;
}

std::span<const int> nearest(const Targets& targets, int target, int count) {
  const auto near = targets.near(target);
  return near.first(std::min<std::size_t>(count, near.size()));
}

// Which is next has a probability in proportion to the square of its prize [Efraimidis and Spirakis 2006].
void put_in_random_order(std::vector<int>& targets, Draft& draft) {
  if (draft.equal_prizes) {
    for (std::size_t i = targets.size(); i > 1; --i) {
      std::swap(targets[i - 1], targets[draft.rng.below(static_cast<std::uint32_t>(i))]);
    }
    return;
  }
  draft.keyed.clear();
  for (const int target : targets) {
    const double prize = draft.targets.prize(target) / draft.mean_prize;
    draft.keyed.emplace_back(-std::log(draft.rng.uniform()) / (prize * prize), target);
  }
  std::sort(draft.keyed.begin(), draft.keyed.end());
  for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = draft.keyed[i].second;
}

void put_in(int target, Draft& draft) {
  if (draft.route.contains(target)) return;
  if (const auto insertion = Insertion::propose(draft, target)) insertion->apply(draft);
}

void put_back_removed(Draft& draft) {
  put_in_random_order(draft.removed, draft);
  for (const int target : draft.removed) put_in(target, draft);
}

// Looks for the cheapest place of a target.
struct PlaceSearch {
  const Targets& targets;
  const Route& route;
  Rng& rng;
  int last;        // before the end
  Insertion best;  // so far; at first what a place may cost

  void consider(int after, double in, double out) {
    const double added = in + out - route.link(after);
    constexpr auto kPassedOver = static_cast<std::uint64_t>(kBlink * 0x1p64);
    if (added >= best.added || rng.next() < kPassedOver) return;
    best = {.target = best.target, .added = added, .after = after, .in = in, .out = out};
  }

  void consider(int after) {
    consider(after, targets.cost(after, best.target), targets.cost(best.target, route.next(after)));
  }

  // Where edges lead both ways. The nearest come first. Of two neighbours in the route the nearer one comes first, so
  // a place beside the other costs at least the way there and back, less the way that it saves.
  void try_neighbours(int target) {
    for (const int near : targets.near(target)) {
      if (!route.contains(near)) continue;
      const double there = targets.cost(target, near);
      const double there_and_back = there + there;
      if (const double link = route.link(near); there_and_back - link < best.added && near != last) {
        const double out = targets.cost(target, route.next(near));
        consider(near, there, out == kNoLimit ? there + link : out);
      }
      if (near == 0) continue;
      const int before = route.previous(near);
      if (const double link = route.link(before); there_and_back - link < best.added) {
        const double in = targets.cost(target, before);
        consider(before, in == kNoLimit ? link + there : in, there);
      }
      if (best.added <= 0) break;
    }
  }

  void try_directed_neighbours(int target) {
    for (const int near : targets.into(target)) {
      if (route.contains(near)) consider(near);
    }
    for (const int near : targets.near(target)) {
      if (near != 0 && route.contains(near)) consider(route.previous(near));
    }
  }

  // Begins a region of its own: only where no near target is in the route.
  void try_everywhere(int target) {
    const auto near = targets.near(target);
    if (std::any_of(near.begin(), near.end(), [&](int one) { return route.contains(one); })) return;
    for (int at = 0; at != last; at = route.next(at)) consider(at);
  }
};

}  // namespace

Draft::Draft(const Targets& on, double cost_limit, std::uint64_t seed)
    : targets(on),
      limit(cost_limit),
      rng(seed),
      route(on),
      mean_prize(on.total_prize() / std::max(1, on.end())),
      equal_prizes(have_equal_prizes(on)),
      marked(on.end() + 1) {}

StringRemoval StringRemoval::propose(Draft& draft, int target, std::uint32_t longest) {
  const std::uint32_t length = 1 + draft.rng.below(longest);
  for (auto back = draft.rng.below(length); back > 0 && draft.route.previous(target) != 0; --back) {
    target = draft.route.previous(target);
  }
  return {.first = target, .length = static_cast<int>(length)};
}

void StringRemoval::apply(Draft& draft) const {
  int target = first;
  for (int left = length; left > 0 && target != draft.targets.end(); --left) {
    const int next = draft.route.next(target);
    draft.route.remove(target);
    draft.removed.push_back(target);
    target = next;
  }
}

std::optional<Reversal> Reversal::propose(const Draft& draft, int one, int other, bool forward) {
  const Route& route = draft.route;
  const bool in_order = route.before(one, other);
  const int early = in_order ? one : other;
  const int late = in_order ? other : one;
  const int first = forward ? route.next(early) : early;
  const int last = forward ? late : route.previous(late);
  if (first == last) return std::nullopt;
  const int before = route.previous(first);
  const double in = draft.targets.cost(before, last);
  const double out = draft.targets.cost(first, route.next(last));
  const double added = in + out - route.link(before) - route.link(last);
  return Reversal{.first = first, .last = last, .in = in, .out = out, .added = added};
}

std::optional<Reversal> Reversal::propose_near(Draft& draft, int target) {
  const Route& route = draft.route;
  if (!route.contains(target)) {
    const auto near = draft.targets.near(target);
    const auto found = std::find_if(near.begin(), near.end(), [&](int one) { return route.contains(one); });
    if (found == near.end()) return std::nullopt;
    target = *found;
  }
  const auto near = nearest(draft.targets, target, kTurnNear);
  if (near.empty()) return std::nullopt;
  const double slack = draft.limit - route.cost();
  for (int i = 0; i < kTurnTries; ++i) {
    const int other = near[draft.rng.below(static_cast<std::uint32_t>(near.size()))];
    const bool forward = (draft.rng.next() >> 63) != 0;
    if (!route.contains(other) || (!forward && (target == 0 || other == 0))) continue;
    const auto found = propose(draft, target, other, forward);
    if (found && found->added <= slack) return found;
  }
  return std::nullopt;
}

std::optional<Insertion> Insertion::propose(Draft& draft, int target) {
  const Targets& targets = draft.targets;
  const Route& route = draft.route;
  const double most = (draft.limit - route.cost()) * (1 + kCostRounding) + kTiny;
  PlaceSearch search{.targets = targets,
                     .route = route,
                     .rng = draft.rng,
                     .last = route.previous(targets.end()),
                     .best = {.target = target, .added = most}};
  if (targets.symmetric()) {
    search.try_neighbours(target);
  } else {
    search.try_directed_neighbours(target);
  }
  search.consider(search.last);
  const Insertion& best = search.best;
  if (best.after == Route::kNone && draft.style().region_share > 0 && targets.has_table()) {
    search.try_everywhere(target);
  }
  if (best.after == Route::kNone || route.cost() + best.added > draft.limit) return std::nullopt;
  return best;
}

void TwoOpt::enqueue(int target, const Draft& draft) {
  if (target == draft.targets.end() || queued_[target] != 0) return;
  queued_[target] = 1;
  queue_.push_back(target);
}

void TwoOpt::apply(const Reversal& reversal, Draft& draft) {
  const int before = draft.route.previous(reversal.first);
  const int after = draft.route.next(reversal.last);
  reversal.apply(draft);
  for (const int touched : {before, reversal.first, reversal.last, after}) enqueue(touched, draft);
}

void TwoOpt::improve(Draft& draft) {
  const Route& route = draft.route;
  route.changed([&](int target, int /*other*/) {
    if (!route.contains(target)) return;
    enqueue(target, draft);
    if (target != 0) enqueue(route.previous(target), draft);
    enqueue(route.next(target), draft);
  });
  while (!queue_.empty()) {
    const int target = queue_.back();
    queue_.pop_back();
    queued_[target] = 0;
    while (route.contains(target) && improve_at(target, draft)) {
    }
  }
}

// Replaces the way on from a target, or the way to it, by one to a nearer target, where that makes the route cheaper.
bool TwoOpt::improve_at(int target, Draft& draft) {
  const Route& route = draft.route;
  const auto near = nearest(draft.targets, target, kTwoOptNear);
  for (const bool forward : {true, false}) {
    if (!forward && target == 0) continue;
    const double link = route.link(forward ? target : route.previous(target));
    for (const int other : near) {
      if (draft.targets.cost(target, other) >= link) break;
      if (!route.contains(other) || (!forward && other == 0)) continue;
      const auto found = Reversal::propose(draft, target, other, forward);
      if (!found) continue;
      const double links = route.link(route.previous(found->first)) + route.link(found->last);
      if (found->added >= -kCostRounding * links) continue;
      apply(*found, draft);
      return true;
    }
  }
  return false;
}

void ruin(Draft& draft, int seed) {
  draft.removed.clear();
  if (draft.targets.symmetric() && draft.rng.uniform() < draft.style().no_string_share) return;
  std::uint32_t strings = 1 + draft.rng.below(kMostStrings);
  const std::uint32_t longest = draft.rng.uniform() < draft.style().long_share ? kLongString : kShortString;
  const auto take_one = [&](int target) {
    if (target == 0 || !draft.route.contains(target)) return;
    StringRemoval::propose(draft, target, longest).apply(draft);
    --strings;
  };
  take_one(seed);
  for (const int target : draft.targets.near(seed)) {
    if (strings == 0) break;
    take_one(target);
  }
}

void recreate(Draft& draft, int seed) {
  const std::size_t taken = draft.removed.size();
  for (const int target : draft.removed) draft.marked[target] = 1;
  const auto add = [&](int target) {
    if (!draft.route.contains(target) && draft.marked[target] == 0) draft.removed.push_back(target);
  };
  add(seed);
  for (const int target : draft.targets.near(seed)) add(target);
  for (std::size_t i = 0; i < taken; ++i) draft.marked[draft.removed[i]] = 0;
  if (const double share = draft.style().elsewhere_share; share > 0 && draft.rng.uniform() < share) {
    // What was given up here may pay elsewhere.
    const int other = draft.random_target();
    put_in(other, draft);
    for (const int target : draft.targets.near(other)) put_in(target, draft);
  }
  put_back_removed(draft);
}

void move_region(Draft& draft, int seed, std::uint32_t longest) {
  const Route& route = draft.route;
  draft.removed.clear();
  for (int i = 0; i < kSeedTries && route.contains(seed); ++i) seed = draft.random_target();
  int first = 0;
  for (int i = 0; i < kSeedTries && (first == 0 || !route.contains(first)); ++i) first = draft.random_target();
  if (first != 0 && route.contains(first)) {
    StringRemoval{.first = first, .length = static_cast<int>(1 + draft.rng.below(longest))}.apply(draft);
  }
  std::vector<int>& region = draft.region;
  region.assign(1, seed);
  int failures = 0;
  for (std::size_t i = 0; i < region.size() && failures < kGrowFailures; ++i) {
    const int target = region[i];
    put_in(target, draft);
    if (!route.contains(target)) {
      ++failures;
      continue;
    }
    for (const int next : nearest(draft.targets, target, kGrowNear)) {
      if (draft.marked[next] != 0 || route.contains(next)) continue;
      draft.marked[next] = 1;
      region.push_back(next);
    }
  }
  for (const int target : region) draft.marked[target] = 0;
  put_back_removed(draft);
}

void cross_over(Draft& draft, const std::vector<int>& other) {
  const double share = kLeastRegion + (kMostRegion - kLeastRegion) * draft.rng.uniform();
  const auto size = static_cast<std::size_t>(std::clamp(share * draft.targets.end(), 1.0, kLargestRegion));
  std::vector<int>& region = draft.region;
  region.assign(1, draft.random_target());
  draft.marked[region[0]] = 1;
  for (std::size_t i = 0; i < region.size() && region.size() < size; ++i) {
    for (const int near : draft.targets.near(region[i])) {
      if (draft.marked[near] != 0 || region.size() == size) continue;
      draft.marked[near] = 1;
      region.push_back(near);
    }
  }
  draft.removed.clear();
  for (const int target : region) {
    if (target == 0 || !draft.route.contains(target)) continue;
    draft.route.remove(target);
    draft.removed.push_back(target);
  }
  for (const int target : other) {
    if (draft.marked[target] != 0) put_in(target, draft);
  }
  for (const int target : region) draft.marked[target] = 0;
  put_back_removed(draft);
}

}  // namespace graphdrl
