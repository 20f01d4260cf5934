#include "graphdrl/planners/exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "graphdrl/planners/beam.h"

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
struct Reach {
  explicit Reach(const SearchStart& start);

  std::vector<NodeId> nodes;               // by local index
  std::vector<NodeSet> neighbours;         // likewise; empty where there are too many nodes
  std::vector<std::vector<double>> costs;  // [from][to], meaningful along edges; of weighted worlds only
  State state{};                           // at the start
};

Reach::Reach(const SearchStart& start) {
  const Graph& open = start.world->open();
  nodes = {start.position};
  std::vector<int> local(open.node_count(), -1);
  local[start.position] = 0;
  for (std::size_t head = 0; head < nodes.size(); ++head) {
    for (const NodeId next : open.neighbours(nodes[head])) {
      if (local[next] >= 0) continue;
      local[next] = 0;
      nodes.push_back(next);
    }
  }
  if (nodes.size() > kExactMaxNodes) return;
  std::sort(nodes.begin(), nodes.end());
  for (std::size_t i = 0; i < nodes.size(); ++i) local[nodes[i]] = static_cast<int>(i);
  neighbours.resize(nodes.size());
  if (open.weighted()) costs.assign(nodes.size(), std::vector<double>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (int k = 0; k < open.degree(nodes[i]); ++k) {
      const int next = local[open.neighbours(nodes[i])[k]];
      neighbours[i] |= bit(next);
      if (open.weighted()) costs[i][next] = open.cost(nodes[i], k);
    }
    if (start.visited[nodes[i]]) state.visited |= bit(static_cast<int>(i));
  }
  state.position = local[start.position];
}

// Where every edge costs 1.
class ExactSearch {
 public:
  explicit ExactSearch(const SearchStart& start, Deadline deadline = {}) : deadline_(deadline) {
    Reach reach(start);
    nodes_ = std::move(reach.nodes);
    neighbours_ = std::move(reach.neighbours);
    start_ = reach.state;
    fits_ = !neighbours_.empty();
    unvisited_ = static_cast<int>(nodes_.size()) - std::popcount(start_.visited);
    budget_ = static_cast<int>(std::min(start.limit(), 1e9));
  }

  std::optional<Optimum> optimum() const;
  std::optional<std::vector<NodeId>> walk();

 private:
  // Whether the deadline passed; looks at the clock now and then.
  bool late(std::size_t states) const { return states % 256 == 0 && passed(deadline_); }

  int gain_of(const State& state) const { return std::popcount(state.visited) - std::popcount(start_.visited); }

  template <typename Visit>
  void for_first_visits(const State& state, int max_distance, const Visit& visit) const;

  // Whether `gain` first visits in all can be had from a state while wasting at most `slack` more steps. Remembers the
  // failures; gives false, and out_of_reach_, after too many.
  bool can_reach(const State& state, int gain, int slack);

  Deadline deadline_;
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
  out_of_reach_ = failed_slack_.size() > kExactMaxStates || late(failed_slack_.size());
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

// Where edges have costs. States are expanded in order of what they can reach at most: the nodes visited, and as many
// of the others as their cheapest arrivals allow.
class WeightedSearch {
 public:
  explicit WeightedSearch(const SearchStart& start, Deadline deadline = {})
      : deadline_(deadline), reach_(start), limit_(start.limit()) {
    if (reach_.neighbours.empty()) return;
    const int count = static_cast<int>(reach_.nodes.size());
    for (int node = 0; node < count; ++node) {
      double least = std::numeric_limits<double>::infinity();
      for (int from = 0; from < count; ++from) {
        if ((reach_.neighbours[from] & bit(node)) != 0) least = std::min(least, reach_.costs[from][node]);
      }
      arrivals_.emplace_back(least, node);
    }
    std::sort(arrivals_.begin(), arrivals_.end());
  }

  std::optional<std::vector<NodeId>> walk();

 private:
  struct Entry {
    State state;
    double spent;
    int gain;
    int most;    // first visits in all, at most
    int before;  // the entry it was reached from
  };

  int most_from(const State& state, int gain, double spent) const {
    for (const auto& [cost, node] : arrivals_) {
      if ((state.visited & bit(node)) != 0) continue;
      spent += cost;
      if (spent > limit_) break;
      ++gain;
    }
    return gain;
  }

  // The order of the heap: the most first, then the deepest, then the cheapest.
  static bool comes_later(const Entry& a, const Entry& b) {
    if (a.most != b.most) return a.most < b.most;
    return a.gain != b.gain ? a.gain < b.gain : a.spent > b.spent;
  }

  void expand(int index);
  std::vector<NodeId> unroll(int index) const;

  Deadline deadline_;
  Reach reach_;
  double limit_;
  std::vector<std::pair<double, int>> arrivals_;  // the cheapest edge into each node, cheapest first
  std::vector<Entry> entries_;
  std::vector<int> heap_;
  std::unordered_map<State, double, StateHash> least_spent_;
};

// Shortest paths through visited ground from one of its nodes to all: Dijkstra's algorithm without a heap, for few
// nodes.
struct ShortestPaths {
  std::array<double, kExactMaxNodes> cost;
  std::array<int, kExactMaxNodes> before;
};

ShortestPaths shortest_paths(const Reach& reach, const State& state) {
  ShortestPaths paths;
  paths.cost.fill(std::numeric_limits<double>::infinity());
  paths.cost[state.position] = 0;
  paths.before[state.position] = state.position;
  NodeSet settled = 0;
  for (;;) {
    int node = -1;
    for (NodeSet rest = state.visited & ~settled; rest != 0; rest &= rest - 1) {
      const int other = std::countr_zero(rest);
      if (node < 0 || paths.cost[other] < paths.cost[node]) node = other;
    }
    if (node < 0 || paths.cost[node] == std::numeric_limits<double>::infinity()) return paths;
    settled |= bit(node);
    for (NodeSet next = reach.neighbours[node] & ~settled; next != 0; next &= next - 1) {
      const int other = std::countr_zero(next);
      const double cost = paths.cost[node] + reach.costs[node][other];
      if (cost >= paths.cost[other]) continue;
      paths.cost[other] = cost;
      paths.before[other] = node;
    }
  }
}

void WeightedSearch::expand(int index) {
  const Entry from = entries_[index];
  const ShortestPaths paths = shortest_paths(reach_, from.state);
  for (int node = 0; node < std::ssize(reach_.nodes); ++node) {
    if ((from.state.visited & bit(node)) != 0 || from.spent + paths.cost[node] > limit_) continue;
    Entry entry{.state = {from.state.visited | bit(node), node},
                .spent = from.spent + paths.cost[node],
                .gain = from.gain + 1,
                .most = 0,
                .before = index};
    const auto [known, fresh] = least_spent_.try_emplace(entry.state, entry.spent);
    if (!fresh && known->second <= entry.spent) continue;
    known->second = entry.spent;
    entry.most = most_from(entry.state, entry.gain, entry.spent);
    heap_.push_back(static_cast<int>(entries_.size()));
    entries_.push_back(entry);
    std::push_heap(heap_.begin(), heap_.end(), [&](int a, int b) { return comes_later(entries_[a], entries_[b]); });
  }
}

std::optional<std::vector<NodeId>> WeightedSearch::walk() {
  if (reach_.neighbours.empty()) return std::nullopt;
  entries_ = {{.state = reach_.state, .spent = 0, .gain = 0, .most = most_from(reach_.state, 0, 0), .before = -1}};
  heap_ = {0};
  int best = 0;
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), [&](int a, int b) { return comes_later(entries_[a], entries_[b]); });
    const int index = heap_.back();
    heap_.pop_back();
    const Entry& entry = entries_[index];
    const auto beats = [&](int gain) {
      return gain > entries_[best].gain || (gain == entries_[best].gain && entry.spent < entries_[best].spent);
    };
    if (entry.most < entries_[best].gain) break;  // nothing left in the heap can have more
    const auto known = least_spent_.find(entry.state);
    if (known != least_spent_.end() && known->second < entry.spent) continue;
    if (beats(entry.gain)) best = index;
    if (!beats(entry.most)) continue;
    expand(index);
    if (entries_.size() > kExactMaxStates || passed(deadline_)) return std::nullopt;
  }
  return unroll(best);
}

std::vector<NodeId> WeightedSearch::unroll(int index) const {
  std::vector<int> chain;
  for (; index > 0; index = entries_[index].before) chain.push_back(index);
  std::reverse(chain.begin(), chain.end());
  std::vector<NodeId> walk = {reach_.nodes[reach_.state.position]};
  for (const int next : chain) {
    const Entry& from = entries_[entries_[next].before];
    const ShortestPaths paths = shortest_paths(reach_, from.state);
    std::vector<NodeId> steps;
    for (int node = entries_[next].state.position; node != from.state.position; node = paths.before[node]) {
      steps.push_back(reach_.nodes[node]);
    }
    walk.insert(walk.end(), steps.rbegin(), steps.rend());
  }
  return walk;
}

}  // namespace

std::optional<int> exact_gain(const SearchStart& start) {
  if (start.world->open().weighted()) {
    const auto walk = WeightedSearch(start).walk();
    if (!walk) return std::nullopt;
    std::vector<bool> visited = start.visited;
    int gain = 0;
    for (const NodeId node : *walk) {
      gain += !visited[node];
      visited[node] = true;
    }
    return gain;
  }
  const auto best = ExactSearch(start).optimum();
  return best ? std::optional(best->gain) : std::nullopt;
}

std::optional<std::vector<NodeId>> exact_walk(const SearchStart& start, Deadline deadline) {
  return start.world->open().weighted() ? WeightedSearch(start, deadline).walk() : ExactSearch(start, deadline).walk();
}

Plan ExactPolicy::plan(const SearchStart& start) {
  const Deadline deadline = deadline_after(limit_);
  Plan plan;
  if (limit_) plan = BeamPolicy({}).plan(start);
  if (auto walk = exact_walk(start, deadline)) return {.walk = *std::move(walk), .optimal = true};
  if (limit_) return plan;
  throw SearchOutOfReach(
      {.what = "exact search is out of reach",
       .expected = fmt::format("at most {} nodes in reach and {} states", kExactMaxNodes, kExactMaxStates),
       .got = fmt::format("{} valid nodes", start.world->valid_count()),
       .where = start.world->name()});
}

}  // namespace graphdrl
