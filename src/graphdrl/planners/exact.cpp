#include "graphdrl/planners/exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>
#include <unordered_set>

#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

constexpr double kRounding = 1e-12;  // of sums of prizes

using NodeSet64 = std::uint64_t;  // of nodes in reach, by local index

constexpr NodeSet64 bit(int node) {
  return NodeSet64{1} << node;
}

struct State {
  NodeSet64 visited;
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
  explicit Reach(const Task& task);
  bool fits() const { return !neighbours.empty(); }

  std::vector<NodeId> nodes;               // by local index; some of them where there are too many
  std::vector<NodeSet64> neighbours;       // likewise; empty where there are too many nodes
  std::vector<std::vector<double>> costs;  // [from][to], meaningful along edges
  std::vector<double> prizes;              // of first visits
  std::vector<double> cost_to_end;         // by any way; 0 where the walk may end anywhere
  State state{};                           // at the start
  int end = -1;                            // -1 for anywhere
};

Reach::Reach(const Task& task) {
  const Graph& open = task.view.open();
  nodes = {task.start};
  NearestFirst().run(open, task.start, task.limit(), [&](NodeId node, double) {
    nodes.push_back(node);
    return nodes.size() > kExactMaxNodes ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
  });
  if (nodes.size() > kExactMaxNodes) return;
  std::sort(nodes.begin(), nodes.end());
  const auto local = [&](NodeId node) {
    const auto place = std::lower_bound(nodes.begin(), nodes.end(), node);
    return place == nodes.end() || *place != node ? -1 : static_cast<int>(place - nodes.begin());
  };
  neighbours.resize(nodes.size());
  costs.assign(nodes.size(), std::vector<double>(nodes.size()));
  const std::vector<double> to_end =
      task.ends_anywhere() ? std::vector<double>() : costs_to(task.view.into(), task.end);
  const graphdrl::NodeSet visited = task.visited_before();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (int k = 0; k < open.degree(nodes[i]); ++k) {
      const int next = local(open.neighbours(nodes[i])[k]);
      if (next < 0) continue;  // beyond the budget
      neighbours[i] |= bit(next);
      costs[i][next] = open.cost(nodes[i], k);
    }
    prizes.push_back(task.view.prize(nodes[i]));
    cost_to_end.push_back(to_end.empty() ? 0 : to_end[nodes[i]]);
    if (visited.contains(nodes[i])) state.visited |= bit(static_cast<int>(i));
  }
  state.position = local(task.start);
  end = task.ends_anywhere() ? -1 : local(task.end);
}

// Where every edge costs 1, every prize is 1 and the walk may end anywhere.
class ExactSearch {
 public:
  explicit ExactSearch(const Task& task, Deadline deadline = {}) : deadline_(deadline) {
    Reach reach(task);
    fits_ = reach.fits();
    nodes_ = std::move(reach.nodes);
    neighbours_ = std::move(reach.neighbours);
    start_ = reach.state;
    unvisited_ = static_cast<int>(nodes_.size()) - std::popcount(start_.visited);
    budget_ = static_cast<int>(std::min(task.limit(), 1e9));
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
  std::vector<NodeId> nodes_;          // by local index
  std::vector<NodeSet64> neighbours_;  // likewise
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
  NodeSet64 seen = bit(state.position);
  NodeSet64 frontier = seen;
  for (int distance = 1; frontier != 0 && distance <= max_distance; ++distance) {
    NodeSet64 next = 0;
    for (; frontier != 0; frontier &= frontier - 1) next |= neighbours_[std::countr_zero(frontier)];
    next &= ~seen;
    seen |= next;
    for (NodeSet64 fresh = next & ~state.visited; fresh != 0; fresh &= fresh - 1) {
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
    for (NodeSet64 next = neighbours_[state.position]; next != 0 && !moved; next &= next - 1) {
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

// Where edges have costs, nodes prizes, or the walk must end somewhere. States are expanded in order of what they can
// be worth at most: what was visited, and as much of the rest as its cheapest arrivals allow.
class GeneralSearch {
 public:
  explicit GeneralSearch(const Task& task, Deadline deadline = {});

  // The best walk; empty where it is out of reach, or late.
  std::optional<std::vector<NodeId>> walk();

 private:
  struct Entry {
    State state;
    double spent;
    double prize;  // of first visits
    double most;   // of all first visits, at most
    int before;    // the entry it was reached from
  };
  struct Arrival {
    double cost;  // of the cheapest edge into the node
    double prize;
    int node;
  };

  double prize_of(NodeSet64 visited) const;
  double most_from(const State& state, double prize, double spent) const;

  // The order of the heap: the most first, then the deepest, then the cheapest.
  bool comes_later(int a, int b) const {
    const Entry& one = entries_[a];
    const Entry& other = entries_[b];
    if (one.most != other.most) return one.most < other.most;
    return one.prize != other.prize ? one.prize < other.prize : one.spent > other.spent;
  }

  int pop();
  void push(const Entry& entry);
  void expand(int index);
  double cost_to_the_end(const Entry& entry) const;
  std::vector<NodeId> unroll(int index) const;

  Deadline deadline_;
  Reach reach_;
  double limit_;
  bool unit_prizes_;
  std::vector<Arrival> arrivals_;  // by cost per prize
  std::vector<Entry> entries_;
  std::vector<int> heap_;
  std::unordered_map<State, double, StateHash> least_spent_;
};

GeneralSearch::GeneralSearch(const Task& task, Deadline deadline)
    : deadline_(deadline), reach_(task), limit_(task.limit()), unit_prizes_(!task.view.has_prizes()) {
  if (!reach_.fits()) return;
  const int count = static_cast<int>(reach_.nodes.size());
  for (int node = 0; node < count; ++node) {
    double least = kNoLimit;
    for (int from = 0; from < count; ++from) {
      if ((reach_.neighbours[from] & bit(node)) != 0) least = std::min(least, reach_.costs[from][node]);
    }
    if (reach_.prizes[node] > 0) arrivals_.push_back({least, reach_.prizes[node], node});
  }
  std::sort(arrivals_.begin(), arrivals_.end(), [](const Arrival& a, const Arrival& b) {
    const double one = a.cost / a.prize;
    const double other = b.cost / b.prize;
    return one != other ? one < other : a.node < b.node;
  });
}

// The same for the same set, in whatever order it was visited.
double GeneralSearch::prize_of(NodeSet64 visited) const {
  double prize = 0;
  for (NodeSet64 rest = visited & ~reach_.state.visited; rest != 0; rest &= rest - 1) {
    prize += reach_.prizes[std::countr_zero(rest)];
  }
  return prize;
}

// With unit prizes whole nodes, else the last one in part.
double GeneralSearch::most_from(const State& state, double prize, double spent) const {
  for (const Arrival& arrival : arrivals_) {
    if ((state.visited & bit(arrival.node)) != 0) continue;
    if (spent + arrival.cost > limit_) {
      return unit_prizes_ ? prize : prize + arrival.prize * (limit_ - spent) / arrival.cost;
    }
    spent += arrival.cost;
    prize += arrival.prize;
  }
  return prize;
}

// Shortest paths through visited ground from one of its nodes to all: Dijkstra's algorithm without a heap, for few
// nodes.
struct ShortestPaths {
  std::array<double, kExactMaxNodes> cost;
  std::array<int, kExactMaxNodes> before;
};

ShortestPaths shortest_paths(const Reach& reach, const State& state) {
  ShortestPaths paths;
  paths.cost.fill(kNoLimit);
  paths.cost[state.position] = 0;
  paths.before[state.position] = state.position;
  NodeSet64 settled = 0;
  for (;;) {
    int node = -1;
    for (NodeSet64 rest = state.visited & ~settled; rest != 0; rest &= rest - 1) {
      const int other = std::countr_zero(rest);
      if (node < 0 || paths.cost[other] < paths.cost[node]) node = other;
    }
    if (node < 0 || paths.cost[node] == kNoLimit) return paths;
    settled |= bit(node);
    for (NodeSet64 next = reach.neighbours[node] & ~settled; next != 0; next &= next - 1) {
      const int other = std::countr_zero(next);
      const double cost = paths.cost[node] + reach.costs[node][other];
      if (cost >= paths.cost[other]) continue;
      paths.cost[other] = cost;
      paths.before[other] = node;
    }
  }
}

void append_path(const Reach& reach, const ShortestPaths& paths, int from, int to, std::vector<NodeId>& walk) {
  const auto first = std::ssize(walk);
  for (int node = to; node != from; node = paths.before[node]) walk.push_back(reach.nodes[node]);
  std::reverse(walk.begin() + first, walk.end());
}

// What it costs to end where the walk must; kNoLimit where it is not there yet.
double GeneralSearch::cost_to_the_end(const Entry& entry) const {
  if (reach_.end < 0 || reach_.end == entry.state.position) return 0;
  if ((entry.state.visited & bit(reach_.end)) == 0) return kNoLimit;
  return shortest_paths(reach_, entry.state).cost[reach_.end];
}

void GeneralSearch::push(const Entry& entry) {
  heap_.push_back(static_cast<int>(entries_.size()));
  entries_.push_back(entry);
  std::push_heap(heap_.begin(), heap_.end(), [&](int a, int b) { return comes_later(a, b); });
}

int GeneralSearch::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), [&](int a, int b) { return comes_later(a, b); });
  const int index = heap_.back();
  heap_.pop_back();
  return index;
}

void GeneralSearch::expand(int index) {
  const Entry from = entries_[index];
  const ShortestPaths paths = shortest_paths(reach_, from.state);
  for (int node = 0; node < std::ssize(reach_.nodes); ++node) {
    if ((from.state.visited & bit(node)) != 0) continue;
    if (from.spent + paths.cost[node] + reach_.cost_to_end[node] > limit_) continue;
    Entry entry{.state = {from.state.visited | bit(node), node},
                .spent = from.spent + paths.cost[node],
                .prize = prize_of(from.state.visited | bit(node)),
                .most = 0,
                .before = index};
    const auto [known, fresh] = least_spent_.try_emplace(entry.state, entry.spent);
    if (!fresh && known->second <= entry.spent) continue;
    known->second = entry.spent;
    entry.most = most_from(entry.state, entry.prize, entry.spent);
    push(entry);
  }
}

std::optional<std::vector<NodeId>> GeneralSearch::walk() {
  if (!reach_.fits()) return std::nullopt;
  push({.state = reach_.state, .spent = 0, .prize = 0, .most = most_from(reach_.state, 0, 0), .before = -1});
  int best = -1;
  double best_cost = kNoLimit;
  // Whether a walk of this prize and cost would be better than the best so far.
  const auto beats = [&](double prize, double cost) {
    if (best < 0) return true;
    return prize > entries_[best].prize || (prize == entries_[best].prize && cost < best_cost);
  };
  while (!heap_.empty()) {
    const int index = pop();
    const Entry entry = entries_[index];
    if (best >= 0 && entry.most < entries_[best].prize * (1 - kRounding))
      break;  // nothing left in the heap can be worth more
    const auto known = least_spent_.find(entry.state);
    if (known != least_spent_.end() && known->second < entry.spent) continue;
    const double cost = entry.spent + cost_to_the_end(entry);
    if (cost <= limit_ && beats(entry.prize, cost)) {
      best = index;
      best_cost = cost;
    }
    if (!beats(entry.most, entry.spent + reach_.cost_to_end[entry.state.position])) continue;
    expand(index);
    if (entries_.size() > kExactMaxStates || passed(deadline_)) return std::nullopt;
  }
  if (best < 0) return std::nullopt;
  return unroll(best);
}

std::vector<NodeId> GeneralSearch::unroll(int index) const {
  std::vector<int> chain;
  for (int i = index; i > 0; i = entries_[i].before) chain.push_back(i);
  std::reverse(chain.begin(), chain.end());
  std::vector<NodeId> walk = {reach_.nodes[reach_.state.position]};
  for (const int next : chain) {
    const Entry& from = entries_[entries_[next].before];
    append_path(reach_, shortest_paths(reach_, from.state), from.state.position, entries_[next].state.position, walk);
  }
  const Entry& last = entries_[index];
  if (reach_.end >= 0) {
    append_path(reach_, shortest_paths(reach_, last.state), last.state.position, reach_.end, walk);
  }
  return walk;
}

bool is_plain(const Task& task) {
  return task.ends_anywhere() && !task.view.has_prizes() && !task.view.open().weighted();
}

// The walk that goes straight to where it must end.
std::vector<NodeId> straight_walk(const Task& task) {
  std::vector<NodeId> walk = {task.start};
  if (task.ends_anywhere() || task.end == task.start) return walk;
  NearestFirst search;
  search.run(task.view.open(), task.start, kNoLimit, [&](NodeId node, double) {
    return node == task.end ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
  });
  search.append_path_to(task.end, walk);
  return walk;
}

}  // namespace

std::optional<double> exact_prize(const Task& task) {
  check(task);
  if (is_plain(task)) {
    const auto best = ExactSearch(task).optimum();
    return best ? std::optional(best->gain + (task.visited.empty() ? 1.0 : 0.0)) : std::nullopt;
  }
  auto walk = GeneralSearch(task).walk();
  return walk ? std::optional(plan_of_walk(task, *std::move(walk)).prize) : std::nullopt;
}

std::optional<std::vector<NodeId>> exact_walk(const Task& task, Deadline deadline) {
  check(task);
  return is_plain(task) ? ExactSearch(task, deadline).walk() : GeneralSearch(task, deadline).walk();
}

Plan ExactPlanner::plan(const Task& task, Deadline deadline, const Report& report) {
  check(task);
  Plan fallback;
  if (deadline) {
    fallback = plan_of_walk(task, straight_walk(task));
    if (fallback_ != nullptr && task.ends_anywhere() && !task.view.has_prizes()) {
      const auto now = std::chrono::steady_clock::now();
      fallback = fallback_->plan(task, now + (*deadline - now) / 2, report);
    }
    if (fallback.optimal) return fallback;
  }
  if (auto walk = exact_walk(task, deadline)) return plan_of_walk(task, *std::move(walk), /*optimal=*/true);
  if (deadline) return fallback;
  const std::size_t reached = Reach(task).nodes.size();
  const bool many = reached > kExactMaxNodes;
  throw SearchOutOfReach(
      {.what = "exact search is out of reach",
       .expected = fmt::format("at most {} nodes in reach and {} states", kExactMaxNodes, kExactMaxStates),
       .got =
           many ? fmt::format("more than {} nodes", kExactMaxNodes) : fmt::format("{} nodes, too many states", reached),
       .where = task.view.name()});
}

}  // namespace graphdrl
