#include "graphdrl/planners/rules.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "graphdrl/base/random.h"
#include "graphdrl/planners/frontier.h"

namespace graphdrl {
namespace {

constexpr std::size_t kMostTrips = 64;      // as many as the episodes of a block in eval/rollout
constexpr double kAsNear = 1 + 1e-9;        // distances that differ by rounding alone
constexpr double kDistanceWeight = 3;       // explore_lite's potential_scale, its default
constexpr double kSizeWeight = 1;           // its gain_scale
constexpr std::uint64_t kTourHeldFor = 15;  // first visits; docs/unknown.md

int visited_neighbours(const Exploration& now, NodeId node) {
  const auto neighbours = now.view().into().neighbours(node);
  return static_cast<int>(std::ranges::count_if(neighbours, [&](NodeId next) { return now.ground().contains(next); }));
}

std::uint32_t seen_at(const View& view, NodeId node) {
  return view.grows() ? view.seen_at(node) : 0;
}

// Takes the best of what it is offered; of ties the first, or any with the same chance.
template <typename Rank>
class Best {
 public:
  Best(bool first, std::uint64_t seed) : first_(first), seed_(seed) {}

  void offer(NodeId node, const Rank& rank) {
    if (node_ != kNoNode && rank < rank_) return;
    if (node_ == kNoNode || rank_ < rank) {
      ties_ = 0;
    } else if (first_) {
      return;
    }
    ++ties_;
    if (ties_ > 1 && derive_seed(seed_, ties_) % ties_ != 0) return;
    node_ = node;
    rank_ = rank;
  }
  NodeId node() const { return node_; }
  const Rank& rank() const { return rank_; }

 private:
  bool first_;
  std::uint64_t seed_;
  std::uint64_t ties_ = 0;
  NodeId node_ = kNoNode;
  Rank rank_ = {};
};

bool always(double /*cost*/) {
  return true;
}

}  // namespace

void FirstVisitPolicy::act(std::span<const Observation> observations, std::span<int> actions, const Clock& /*clock*/) {
  for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = act_on(observations[i]);
}

// The trip of a walk, with the step that is next; null where there is none. Walks may be asked for once more from where
// they were before.
FirstVisitPolicy::Trip* FirstVisitPolicy::trip_of(const Observation& now) {
  for (Trip& trip : trips_) {
    if (trip.hashes[trip.next] == now.walk_hash && trip.view == now.view()) return &trip;
  }
  for (Trip& trip : trips_) {
    const auto before = std::ranges::find(trip.hashes, now.walk_hash);
    if (before == trip.hashes.end() || !(trip.view == now.view())) continue;
    trip.next = static_cast<std::size_t>(before - trip.hashes.begin());
    return &trip;
  }
  return nullptr;
}

int FirstVisitPolicy::act_on(const Observation& now) {
  Trip* trip = trip_of(now);
  if (trip == nullptr || !holds(*trip, now)) {
    const Exploration exploration(now, now.ground());
    NodeId goal = choose(exploration, now);
    if (goal == kNoNode) {
      const NodeId end = now.task->end();
      if (end == kNoNode || end == now.position) return kStop;
      search_.run_cheapest(now.view().open(), now.position, kNoLimit, [&](NodeId node, double) {
        return node == end ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
      });
      goal = end;
    }
    if (trip == nullptr && trips_.size() < kMostTrips) {
      trip = &trips_.emplace_back(Trip{.view = now.view(), .version = 0});
    } else if (trip == nullptr) {
      trip = &trips_[oldest_++ % kMostTrips];
      trip->view = now.view();
    }
    trip->version = now.view().version();
    trip->way.clear();
    search_.append_path_to(goal, trip->way);
    trip->hashes.assign(1, now.walk_hash);
    for (const NodeId node : trip->way) trip->hashes.push_back(extended_walk_hash(trip->hashes.back(), node));
    trip->next = 0;
  }
  const int action = now.action_to(trip->way[trip->next++]);
  if (action == kNoAction || !now.affordable(action))
    throw std::logic_error("a policy takes a step that cannot be taken");
  return action;
}

// What was chosen is held for some first visits although more becomes known, while it is no ground, the way is there
// and the next step can be paid for.
bool FirstVisitPolicy::holds(const Trip& trip, const Observation& now) const {
  if (trip.next == trip.way.size()) return false;
  if (trip.version == now.view().version()) return true;
  if (now.view().version() - trip.version >= held_for_ || now.ground().contains(trip.way.back())) return false;
  NodeId from = now.position;
  for (std::size_t step = trip.next; step < trip.way.size(); from = trip.way[step++]) {
    if (now.view().open().index_of(from, trip.way[step]) < 0) return false;
  }
  return now.affordable(now.action_to(trip.way[trip.next]));
}

RulePolicy::RulePolicy(Rule rule, int smallest_part)
    : FirstVisitPolicy(rule == Rule::kTour ? kTourHeldFor : 0), rule_(rule), smallest_part_(smallest_part) {}

NodeId RulePolicy::choose(const Exploration& now, const Observation& observation) {
  switch (rule_) {
    case Rule::kTour:
      return first_stop_of_frontier_tour(now, search(), smallest_part_);
    case Rule::kDepthFirst:
      return choose_last_seen(now, observation.walk_hash);
    case Rule::kFrontier:
      return choose_by_frontier(now);
    case Rule::kNearest:
    case Rule::kPocket:
    case Rule::kOpen:
      break;
  }
  return choose_nearest(now, observation.walk_hash);
}

NodeId RulePolicy::choose_nearest(const Exploration& now, std::uint64_t walk_hash) {
  const bool first = now.view().ordered();
  Best<std::pair<int, std::uint32_t>> best(first, walk_hash);  // by neighbours visited, then by when it was seen
  double nearest = kNoLimit;
  const auto look_at = [&](NodeId node, double cost) {
    if (cost > nearest * kAsNear) return false;
    nearest = std::min(nearest, cost);
    if (rule_ == Rule::kNearest) {
      best.offer(node, {});
      return !first;
    }
    best.offer(node, {visited_neighbours(now, node) * (rule_ == Rule::kOpen ? -1 : 1), seen_at(now.view(), node)});
    return true;
  };
  now.for_first_visits(search(), look_at, always);
  return best.node();
}

NodeId RulePolicy::choose_last_seen(const Exploration& now, std::uint64_t walk_hash) {
  const View& view = now.view();
  // Nothing was seen later.
  std::uint32_t last = 0;
  const auto recent = view.recent();
  for (auto node = recent.rbegin(); node != recent.rend() && last == 0; ++node) {
    if (view.is_frontier(*node) && now.is_new(*node)) last = view.seen_at(*node);
  }
  Best<std::pair<std::uint32_t, double>> best(view.ordered(), walk_hash);  // by when it was seen, then by nearness
  const auto look_at = [&](NodeId node, double cost) {
    if (best.node() != kNoNode && best.rank().first == last && cost > -best.rank().second * kAsNear) return false;
    best.offer(node, {seen_at(view, node), -cost});
    return !view.ordered() || best.rank().first != last;
  };
  now.for_first_visits(search(), look_at, always);
  return best.node();
}

NodeId RulePolicy::choose_by_frontier(const Exploration& now) {
  NodeId best = kNoNode;
  double least = kNoLimit;
  for (const FrontierPart& part : frontier_parts(now, search(), std::numeric_limits<int>::max())) {
    const double potential =
        kDistanceWeight * part.nearest.cost - kSizeWeight * now.view().open().mean_cost() * part.size;
    if (potential < least) {
      least = potential;
      best = part.nearest.node;
    }
  }
  return best;
}

}  // namespace graphdrl
