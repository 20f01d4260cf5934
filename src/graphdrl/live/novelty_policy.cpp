#include "graphdrl/live/novelty_policy.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace graphdrl {
namespace {

// Tuned on fifteen machines of others, none of those in the table of docs/live.md: what they cost there is in it, too.
constexpr double kNamePrior = 16;        // tries of the general share that a name begins with
constexpr double kStatePrior = 8;        // likewise a state
constexpr double kTargetWeight = 0.1;    // of a state that moves of a name led to, known or not
constexpr double kMemory = 0.95;         // of what came of a name, with each later try
constexpr double kStrandedWeight = 0.3;  // of the way from where a name leads to the next untried move
constexpr double kFarthestStranded = 3;  // mean edges; farther ways count like that
constexpr double kOnceFound = 0.3;       // of the general share, where names find something once: those that have …
constexpr double kNeverFound = 1.3;      // … and those that have not
constexpr double kClearlyBetter = 1.1;   // so many times; else the nearer move, or the one offered first
constexpr double kLeastChance = 0.001;
constexpr double kMostChance = 0.99;
constexpr double kAsNear = 1 + 1e-9;

}  // namespace

std::array<double, NoveltyPolicy::kModels> NoveltyPolicy::chances(std::int32_t state, std::int32_t name) const {
  const double general = (all_.found + 1) / (all_.tries + 2);
  double by_name = general;
  double by_state = general;
  double once = kNeverFound * general;
  if (name < std::ssize(by_name_)) {
    const Named& named = by_name_[name];
    by_name =
        (named.recent.found + kTargetWeight * named.targets + kNamePrior * general) / (named.recent.tries + kNamePrior);
    if (named.has_found) once = kOnceFound * general;
  }
  if (state < std::ssize(by_state_)) {
    const Tries& here = by_state_[state];
    by_state = (here.found + kStatePrior * general) / (here.tries + kStatePrior);
  }
  std::array<double, kModels> chances = {
      general, by_name, once, by_state, by_name * by_state / general, once * by_state / general};
  for (double& chance : chances) chance = std::clamp(chance, kLeastChance, kMostChance);
  return chances;
}

double NoveltyPolicy::chance(std::int32_t state, std::int32_t name) const {
  const auto each = chances(state, name);
  const double most = *std::ranges::max_element(log_likelihood_);
  double sum = 0;
  double weights = 0;
  for (int model = 0; model < kModels; ++model) {
    const double weight = std::exp(log_likelihood_[model] - most);
    sum += weight * each[model];
    weights += weight;
  }
  return sum / weights;
}

void NoveltyPolicy::learn(std::int32_t state, std::int32_t move, std::int32_t to, bool is_new) {
  const std::int32_t name = graph_->moves(state)[move].name;
  const auto each = chances(state, name);
  for (int model = 0; model < kModels; ++model)
    log_likelihood_[model] += std::log(is_new ? each[model] : 1 - each[model]);
  by_name_.resize(std::max<std::size_t>(by_name_.size(), name + 1));
  by_state_.resize(std::max<std::size_t>(by_state_.size(), state + 1));
  const double found = is_new ? 1 : 0;
  Named& named = by_name_[name];
  named.has_found = named.has_found || is_new;
  named.recent = {.tries = named.recent.tries * kMemory + 1, .found = named.recent.found * kMemory + found};
  for (Tries* const tries : {&all_, &by_state_[state]}) {
    tries->tries += 1;
    tries->found += found;
  }
  const std::uint64_t pair = static_cast<std::uint64_t>(name) << 32 | static_cast<std::uint32_t>(to);
  if (to != state && seen_.insert(pair).second) ++named.targets;
  named.last[named.outcomes++ % kMostOutcomes] = to == state ? -1 : to;
}

// From a state to the next one with untried moves.
double NoveltyPolicy::cost_to_untried(const Exploration& now, std::int32_t state) {
  if (graph_->untried_count(state) > 0) return 0;
  to_untried_.resize(graph_->state_count());
  looked_up_.resize(graph_->state_count());
  if (looked_up_[state] == choice_) return to_untried_[state];
  const Graph& open = now.view().open();
  const double most = kFarthestStranded * open.mean_cost();
  double cost = most;
  look_.run(open, graph_->node(state), most, [&](NodeId node, double so_far) {
    if (!now.ground().contains(node)) return NearestFirst::Next::kPast;
    if (graph_->place(node).state < 0 || graph_->untried_count(graph_->place(node).state) == 0) {
      return NearestFirst::Next::kThrough;
    }
    cost = so_far;
    return NearestFirst::Next::kEnd;
  });
  looked_up_[state] = choice_;
  return to_untried_[state] = cost;
}

// What the way from where moves of a name led to the next untried move costs, in the mean.
double NoveltyPolicy::stranded(const Exploration& now, std::int32_t state, std::int32_t name) {
  if (name >= std::ssize(by_name_)) return 0;
  const Named& named = by_name_[name];
  const int known = std::min(named.outcomes, kMostOutcomes);
  double sum = 0;
  for (int i = 0; i < known; ++i) {
    if (named.last[i] >= 0) {
      sum += cost_to_untried(now, named.last[i]);
    } else {
      sum += graph_->untried_count(state) > 1 ? 0 : now.view().open().mean_cost();
    }
  }
  return sum / (known + 1);
}

NodeId NoveltyPolicy::choose(const Exploration& now, const Observation& /*observation*/) {
  ++choice_;
  const bool states = graph_->cover() == Cover::kNodes;
  NodeId best = kNoNode;
  std::tuple<double, double, int> least;  // what comes first
  double nearest = kNoLimit;
  int left = kMostCandidates;
  const auto look_at = [&](NodeId node, double cost) {
    nearest = std::min(nearest, cost);
    if (!states && cost > nearest * kAsNear) return false;
    const StateGraph::Place place = graph_->place(node);
    std::tuple<double, double, int> rank;
    if (place.move < 0) {  // a state that was heard of
      rank = {states ? cost / kMostChance : cost, 0, 0};
    } else {
      const std::int32_t name = graph_->moves(place.state)[place.move].name;
      const double lost = stranded(now, place.state, name);
      rank = states ? std::tuple((cost + kStrandedWeight * lost) / chance(place.state, name), 0.0, 0)
                    : std::tuple(nearest, lost, -graph_->untried_count(place.state));
    }
    const bool better = states ? std::get<0>(rank) * kClearlyBetter < std::get<0>(least) : rank < least;
    if (best == kNoNode || better) {
      best = node;
      least = rank;
    }
    // Nothing farther can come first once even a certain find there would not.
    return --left > 0 && (!states || cost / kMostChance < std::get<0>(least));
  };
  now.for_first_visits(search(), look_at, [](double) { return true; });
  return best;
}

}  // namespace graphdrl
