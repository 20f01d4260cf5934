#include <algorithm>
#include <bit>
#include <unordered_map>
#include <unordered_set>

#include "graphdrl/planners/exact_search.h"

namespace graphdrl {
namespace {

struct Optimum {
  int gain;   // nodes first visited
  int waste;  // steps that visited nothing new
};

class PlainSearch {
 public:
  explicit PlainSearch(const Task& task, const Clock& clock = {}) : clock_(clock) {
    SmallWorld world(task);
    fits_ = world.fits();
    nodes_ = std::move(world.nodes);
    neighbours_ = std::move(world.neighbours);
    start_ = world.state;
    unvisited_ = static_cast<int>(nodes_.size()) - std::popcount(start_.visited);
    budget_ = static_cast<int>(std::min(task.limit(), 1e9));
  }

  std::optional<Optimum> optimum() const;
  std::optional<std::vector<NodeId>> walk();

 private:
  // Whether the clock passed; looks at the clock now and then.
  bool late(std::size_t states) const { return states % 256 == 0 && clock_.passed(); }

  int gain_of(const ExactState& state) const { return std::popcount(state.visited) - std::popcount(start_.visited); }

  template <typename Visit>
  void for_first_visits(const ExactState& state, int max_distance, const Visit& visit) const;

  // Whether `gain` first visits in all can be had from a state while wasting at most `slack` more steps. Remembers the
  // failures; gives false, and out_of_reach_, after too many.
  bool can_reach(const ExactState& state, int gain, int slack);

  Clock clock_;
  std::vector<NodeId> nodes_;         // by local index
  std::vector<NodeMask> neighbours_;  // likewise
  ExactState start_{};
  int unvisited_ = 0;
  int budget_ = 0;
  bool fits_ = false;
  std::unordered_map<ExactState, int, ExactStateHash> failed_slack_;
  bool out_of_reach_ = false;
};

// Calls visit(node, distance) for every unvisited node next to visited ground that can be reached within max_distance
// steps through visited ground, nearest first.
template <typename Visit>
void PlainSearch::for_first_visits(const ExactState& state, int max_distance, const Visit& visit) const {
  NodeMask seen = bit(state.position);
  NodeMask frontier = seen;
  for (int distance = 1; frontier != 0 && distance <= max_distance; ++distance) {
    NodeMask next = 0;
    for (; frontier != 0; frontier &= frontier - 1) next |= neighbours_[std::countr_zero(frontier)];
    next &= ~seen;
    seen |= next;
    for (NodeMask fresh = next & ~state.visited; fresh != 0; fresh &= fresh - 1) {
      visit(std::countr_zero(fresh), distance);
    }
    frontier = next & state.visited;
  }
}

std::optional<Optimum> PlainSearch::optimum() const {
  if (!fits_) return std::nullopt;
  const int max_gain = std::min(unvisited_, budget_);
  Optimum best{.gain = 0, .waste = 0};
  std::unordered_set<ExactState, ExactStateHash> expanded;
  std::vector<std::vector<ExactState>> open = {
      {start_}};  // by waste; last in, first out, to dive for a good walk early
  for (int waste = 0; waste < static_cast<int>(open.size()); ++waste) {
    while (!open[waste].empty()) {
      if (best.gain == max_gain || best.gain + 1 > budget_ - waste) return best;
      const ExactState state = open[waste].back();
      open[waste].pop_back();
      if (!expanded.insert(state).second) continue;
      if (expanded.size() > kExactMaxStates || late(expanded.size())) return std::nullopt;
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

bool PlainSearch::can_reach(const ExactState& state, int gain, int slack) {
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
  out_of_reach_ = failed_slack_.size() > kExactMaxStates || late(failed_slack_.size());
  return false;
}

std::optional<std::vector<NodeId>> PlainSearch::walk() {
  const std::optional<Optimum> best = optimum();
  if (!best) return std::nullopt;
  std::vector<NodeId> walk = {nodes_[start_.position]};
  ExactState state = start_;
  int slack = best->waste;
  while (gain_of(state) < best->gain) {
    // The lowest neighbour from which the optimum is still in reach: the lexicographically first walk.
    bool moved = false;
    for (NodeMask next = neighbours_[state.position]; next != 0 && !moved; next &= next - 1) {
      const int node = std::countr_zero(next);
      const bool first_visit = (state.visited & bit(node)) == 0;
      const ExactState after{state.visited | bit(node), node};
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

std::optional<int> plain_exact_gain(const Task& task) {
  const auto best = PlainSearch(task, {}).optimum();
  return best ? std::optional(best->gain) : std::nullopt;
}

std::optional<std::vector<NodeId>> plain_exact_walk(const Task& task, const Clock& clock) {
  return PlainSearch(task, clock).walk();
}

}  // namespace graphdrl
