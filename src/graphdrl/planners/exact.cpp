#include "graphdrl/planners/exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace graphdrl {
namespace {

using NodeSet = std::uint64_t;  // by local index

constexpr NodeSet bit(int node) {
  return NodeSet{1} << node;
}

struct State {
  NodeSet visited;
  int position;
  friend bool operator==(const State&, const State&) = default;
};

struct StateHash {
  std::size_t operator()(const State& state) const {
    std::uint64_t h = (state.visited ^ (static_cast<std::uint64_t>(state.position) << 58)) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return h ^ (h >> 32);
  }
};

struct Optimum {
  int gain;
  int waste;
};

// The part of a world in reach of a start, its nodes numbered in ascending order of id.
class ExactSearch {
 public:
  explicit ExactSearch(const SearchStart& start) {
    const World& world = *start.world;
    std::vector<NodeId> reached = {start.position};
    std::vector<int> local(world.graph().node_count(), -1);
    local[start.position] = 0;
    for (std::size_t head = 0; head < reached.size(); ++head) {
      for (const NodeId next : world.open_neighbours(reached[head])) {
        if (local[next] < 0) {
          local[next] = 0;
          reached.push_back(next);
        }
      }
    }
    std::sort(reached.begin(), reached.end());
    nodes_ = reached;
    fits_ = nodes_.size() <= kExactMaxNodes;
    if (!fits_) return;
    for (std::size_t i = 0; i < nodes_.size(); ++i) local[nodes_[i]] = static_cast<int>(i);
    neighbours_.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (const NodeId next : world.open_neighbours(nodes_[i])) neighbours_[i] |= bit(local[next]);
      if (start.visited[nodes_[i]]) start_.visited |= bit(static_cast<int>(i));
    }
    start_.position = local[start.position];
    unvisited_ = static_cast<int>(nodes_.size()) - std::popcount(start_.visited);
    budget_ = static_cast<int>(std::min(start.budget_left, 1e9));
  }

  std::optional<Optimum> optimum() const;
  std::optional<std::vector<NodeId>> walk();

 private:
  int gain_of(const State& state) const { return std::popcount(state.visited) - std::popcount(start_.visited); }

  template <typename Visit>
  void for_first_visits(const State& state, int max_distance, const Visit& visit) const;

  // Whether `gain` first visits in all can be had from a state while wasting at most `slack` more steps. Remembers the
  // failures; gives false, and out_of_reach_, after too many.
  bool can_reach(const State& state, int gain, int slack);

  std::vector<NodeId> nodes_;        // by local index
  std::vector<NodeSet> neighbours_;  // likewise
  State start_{};
  int unvisited_ = 0;
  int budget_ = 0;
  bool fits_ = false;
  std::unordered_map<State, int, StateHash> failed_slack_;
  bool out_of_reach_ = false;
};

// Calls visit(node, distance) for every unvisited node next to visited ground that can be reached within max_distance
// steps through visited ground, nearest first.
template <typename Visit>
void ExactSearch::for_first_visits(const State& state, int max_distance, const Visit& visit) const {
  NodeSet seen = bit(state.position);
  NodeSet frontier = seen;
  for (int distance = 1; frontier != 0 && distance <= max_distance; ++distance) {
    NodeSet next = 0;
    for (; frontier != 0; frontier &= frontier - 1) next |= neighbours_[std::countr_zero(frontier)];
    next &= ~seen;
    seen |= next;
    for (NodeSet fresh = next & ~state.visited; fresh != 0; fresh &= fresh - 1) {
      visit(std::countr_zero(fresh), distance);
    }
    frontier = next & state.visited;
  }
}

std::optional<Optimum> ExactSearch::optimum() const {
  if (!fits_) return std::nullopt;
  const int max_gain = std::min(unvisited_, budget_);
  Optimum best{.gain = 0, .waste = 0};
  std::unordered_set<State, StateHash> expanded;
  std::vector<std::vector<State>> open = {{start_}};  // by waste; last in, first out, to dive for a good walk early
  for (int waste = 0; waste < static_cast<int>(open.size()); ++waste) {
    while (!open[waste].empty()) {
      if (best.gain == max_gain || best.gain + 1 > budget_ - waste) return best;
      const State state = open[waste].back();
      open[waste].pop_back();
      if (!expanded.insert(state).second) continue;
      if (expanded.size() > kExactMaxStates) return std::nullopt;
      const int gain = gain_of(state);
      if (gain > best.gain) best = {.gain = gain, .waste = waste};
      for_first_visits(state, budget_ - gain - waste, [&](int node, int distance) {
        const int next_waste = waste + distance - 1;
        if (next_waste >= static_cast<int>(open.size())) open.resize(next_waste + 1);
        open[next_waste].push_back({state.visited | bit(node), node});
      });
    }
  }
  return best;
}

bool ExactSearch::can_reach(const State& state, int gain, int slack) {
  if (gain_of(state) == gain) return true;
  const auto known = failed_slack_.find(state);
  if (known != failed_slack_.end() && known->second >= slack) return false;
  bool reached = false;
  for_first_visits(state, slack + 1, [&](int node, int distance) {
    if (reached || out_of_reach_) return;
    reached = can_reach({state.visited | bit(node), node}, gain, slack - (distance - 1));
  });
  if (reached || out_of_reach_) return reached;
  failed_slack_[state] = slack;
  out_of_reach_ = failed_slack_.size() > kExactMaxStates;
  return false;
}

std::optional<std::vector<NodeId>> ExactSearch::walk() {
  const std::optional<Optimum> best = optimum();
  if (!best) return std::nullopt;
  std::vector<NodeId> walk = {nodes_[start_.position]};
  State state = start_;
  int slack = best->waste;
  while (gain_of(state) < best->gain) {
    // The lowest neighbour from which the optimum is still in reach: the lexicographically first walk.
    bool moved = false;
    for (NodeSet next = neighbours_[state.position]; next != 0 && !moved; next &= next - 1) {
      const int node = std::countr_zero(next);
      const bool first_visit = (state.visited & bit(node)) == 0;
      const State after{state.visited | bit(node), node};
      const int slack_after = first_visit ? slack : slack - 1;
      if (slack_after < 0 || !can_reach(after, best->gain, slack_after)) continue;
      state = after;
      slack = slack_after;
      moved = true;
    }
    if (!moved) return std::nullopt;  // out of reach: too many states
    walk.push_back(nodes_[state.position]);
  }
  return walk;
}

}  // namespace

SearchStart search_start(const World& world, NodeId start, double budget) {
  SearchStart result{.world = &world, .position = start, .visited = {}, .budget_left = budget};
  result.visited.resize(world.graph().node_count());
  result.visited[start] = true;
  return result;
}

std::optional<int> exact_gain(const SearchStart& start) {
  const auto best = ExactSearch(start).optimum();
  return best ? std::optional(best->gain) : std::nullopt;
}

std::optional<std::vector<NodeId>> exact_walk(const SearchStart& start) {
  return ExactSearch(start).walk();
}

int ExactPolicy::act_on(const Observation& observation) {
  const World& world = *observation.world;
  const auto steps = static_cast<std::ptrdiff_t>(observation.walk.size()) - 1;
  const NodeId start = observation.walk.front();
  const double budget = observation.budget_left + static_cast<double>(steps);
  const auto plan = [&](const SearchStart& from) {
    auto walk = exact_walk(from);
    if (!walk) {
      throw SearchOutOfReach(
          {.what = "exact search is out of reach",
           .expected = fmt::format("at most {} nodes in reach and {} states", kExactMaxNodes, kExactMaxStates),
           .got = fmt::format("{} valid nodes", world.valid_count()),
           .where = world.name()});
    }
    return *std::move(walk);
  };
  auto known = walks_.find({&world, start, budget});
  if (known == walks_.end()) {
    known = walks_.emplace(std::tuple(&world, start, budget), plan(search_start(world, start, budget))).first;
  }
  const std::vector<NodeId>& walk = known->second;
  const bool on_plan =
      steps < std::ssize(walk) && std::equal(observation.walk.begin(), observation.walk.end(), walk.begin());
  if (on_plan) return steps + 1 < std::ssize(walk) ? observation.action_to(walk[steps + 1]) : kStop;

  // Someone else led the way here: plan from this state.
  SearchStart here{
      .world = &world, .position = observation.position, .visited = {}, .budget_left = observation.budget_left};
  for (const std::uint32_t visits : observation.visits) here.visited.push_back(visits > 0);
  const std::vector<NodeId> rest = plan(here);
  return rest.size() < 2 ? kStop : observation.action_to(rest[1]);
}

}  // namespace graphdrl
