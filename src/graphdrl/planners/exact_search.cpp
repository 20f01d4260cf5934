// The two exact searches, in worlds small enough for sets of nodes to be words.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "graphdrl/planners/exact.h"

namespace graphdrl {
namespace {

using NodeMask = std::uint64_t;  // of nodes in reach, by local index

constexpr NodeMask bit(int node) {
  return NodeMask{1} << node;
}

struct ExactState {
  NodeMask visited;
  int position;
  friend bool operator==(const ExactState&, const ExactState&) = default;
};

struct ExactStateHash {
  std::size_t operator()(const ExactState& state) const {
    std::uint64_t h = (state.visited ^ (static_cast<std::uint64_t>(state.position) << 58)) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return h ^ (h >> 32);
  }
};

// The part of a world that a task can reach, its nodes numbered in ascending order of id.
struct SmallWorld {
  explicit SmallWorld(const Task& task) {
    const Graph& open = task.view().open();
    nodes = {task.start()};
    NearestFirst().run_cheapest(open, task.start(), task.limit(), [&](NodeId node, double) {
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
    const NodeSet visited = task.ground();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (int k = 0; k < open.degree(nodes[i]); ++k) {
        const int next = local(open.neighbours(nodes[i])[k]);
        if (next < 0) continue;  // beyond the budget
        neighbours[i] |= bit(next);
        costs[i][next] = open.cost(nodes[i], k);
      }
      prizes.push_back(task.prize(nodes[i]));
      cost_to_end.push_back(task.cost_to_end(nodes[i]));
      if (visited.contains(nodes[i])) state.visited |= bit(static_cast<int>(i));
    }
    state.position = local(task.start());
    end = task.ends_anywhere() ? -1 : local(task.end());
  }

  bool fits() const { return !neighbours.empty(); }

  std::vector<NodeId> nodes;               // by local index; only some of them if too many
  std::vector<NodeMask> neighbours;        // by local index; empty if too many
  std::vector<std::vector<double>> costs;  // [from][to], meaningful along edges
  std::vector<double> prizes;              // of first visits
  std::vector<double> cost_to_end;         // by any way; 0 where the walk may end anywhere
  ExactState state{};                      // at the start
  int end = -1;                            // -1 for anywhere
};

struct Optimum {
  int gain;   // nodes first visited
  int waste;  // steps that visited nothing new
};

// In order of waste [exact.h]. From all starts of the paper's ten maps this takes 0.1 s, the general search 13 s; on
// twenty 5x5 grids with obstacles at 1.0x 0.3 s and 11 s (one thread).
class PlainSearch {
 public:
  explicit PlainSearch(const Task& task, const Clock& clock = {})
      : clock_(clock), world_(task), budget_(static_cast<int>(std::min(task.limit(), 1e9))) {}

  // Empty if out of reach, or once the clock passes, as the walk.
  std::optional<Optimum> optimum() const {
    if (!world_.fits()) return std::nullopt;
    const int unvisited = static_cast<int>(world_.nodes.size()) - std::popcount(world_.state.visited);
    const int max_gain = std::min(unvisited, budget_);
    Optimum best{.gain = 0, .waste = 0};
    std::unordered_set<ExactState, ExactStateHash> expanded;
    // By waste; last in, first out, to dive for a good walk early.
    std::vector<std::vector<ExactState>> open = {{world_.state}};
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

  std::optional<std::vector<NodeId>> walk() {
    const std::optional<Optimum> best = optimum();
    if (!best) return std::nullopt;
    ExactState state = world_.state;
    std::vector<NodeId> walk = {world_.nodes[state.position]};
    int slack = best->waste;
    while (gain_of(state) < best->gain) {
      // The lowest neighbour from which the optimum is still in reach: the lexicographically first walk.
      bool moved = false;
      for (NodeMask next = world_.neighbours[state.position]; next != 0 && !moved; next &= next - 1) {
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
      walk.push_back(world_.nodes[state.position]);
    }
    return walk;
  }

 private:
  // Whether the clock passed; looks at the clock now and then.
  bool late(std::size_t states) const { return states % 256 == 0 && clock_.passed(); }

  int gain_of(const ExactState& state) const {
    return std::popcount(state.visited) - std::popcount(world_.state.visited);
  }

  // Calls visit(node, distance) for every unvisited node next to visited ground that can be reached within max_distance
  // steps through visited ground, nearest first.
  template <typename Visit>
  void for_first_visits(const ExactState& state, int max_distance, const Visit& visit) const {
    NodeMask seen = bit(state.position);
    NodeMask frontier = seen;
    for (int distance = 1; frontier != 0 && distance <= max_distance; ++distance) {
      NodeMask next = 0;
      for (; frontier != 0; frontier &= frontier - 1) next |= world_.neighbours[std::countr_zero(frontier)];
      next &= ~seen;
      seen |= next;
      for (NodeMask fresh = next & ~state.visited; fresh != 0; fresh &= fresh - 1) {
        visit(std::countr_zero(fresh), distance);
      }
      frontier = next & state.visited;
    }
  }

  // Whether `gain` first visits in all can be had from a state while wasting at most `slack` more steps. Remembers the
  // failures; gives false, and out_of_reach_, after too many.
  bool can_reach(const ExactState& state, int gain, int slack) {
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

  Clock clock_;
  SmallWorld world_;
  int budget_;
  std::unordered_map<ExactState, int, ExactStateHash> failed_slack_;
  bool out_of_reach_ = false;
};

// Shortest paths through visited ground from one of its nodes to all: Dijkstra's algorithm without a heap, for few
// nodes.
struct ShortestPaths {
  std::array<double, kExactMaxNodes> cost;
  std::array<int, kExactMaxNodes> before;
};

ShortestPaths shortest_paths(const SmallWorld& world, const ExactState& state) {
  ShortestPaths paths;
  paths.cost.fill(kNoLimit);
  paths.cost[state.position] = 0;
  paths.before[state.position] = state.position;
  NodeMask settled = 0;
  for (;;) {
    int node = -1;
    for (NodeMask rest = state.visited & ~settled; rest != 0; rest &= rest - 1) {
      const int other = std::countr_zero(rest);
      if (node < 0 || paths.cost[other] < paths.cost[node]) node = other;
    }
    if (node < 0 || paths.cost[node] == kNoLimit) return paths;
    settled |= bit(node);
    for (NodeMask next = world.neighbours[node] & ~settled; next != 0; next &= next - 1) {
      const int other = std::countr_zero(next);
      const double cost = paths.cost[node] + world.costs[node][other];
      if (cost >= paths.cost[other]) continue;
      paths.cost[other] = cost;
      paths.before[other] = node;
    }
  }
}

// In order of an upper bound of worth [exact.h], for any task.
class GeneralSearch {
 public:
  explicit GeneralSearch(const Task& task, const Clock& clock = {})
      : clock_(clock), world_(task), limit_(task.limit()), unit_prizes_(!task.has_prizes()) {
    if (!world_.fits()) return;
    const int count = static_cast<int>(world_.nodes.size());
    for (int node = 0; node < count; ++node) {
      double least = kNoLimit;
      for (int from = 0; from < count; ++from) {
        if ((world_.neighbours[from] & bit(node)) != 0) least = std::min(least, world_.costs[from][node]);
      }
      if (world_.prizes[node] > 0) arrivals_.push_back({least, world_.prizes[node], node});
    }
    std::sort(arrivals_.begin(), arrivals_.end(), [](const Arrival& a, const Arrival& b) {
      const double one = a.cost / a.prize;
      const double other = b.cost / b.prize;
      return one != other ? one < other : a.node < b.node;
    });
  }

  // The best walk. Empty if out of reach, or once the clock passes.
  std::optional<std::vector<NodeId>> walk() {
    if (!world_.fits()) return std::nullopt;
    push({.state = world_.state, .spent = 0, .prize = 0, .most = most_from(world_.state, 0, 0), .before = -1});
    int best = -1;
    double best_cost = kNoLimit;
    // Whether a walk of this prize and cost would be better than the best so far.
    const auto beats = [&](double prize, double cost) {
      if (best < 0) return true;
      return prize > entries_[best].prize || (prize == entries_[best].prize && cost < best_cost);
    };
    while (!open_.empty()) {
      const int index = open_.top();
      open_.pop();
      const Entry entry = entries_[index];
      // Nothing left can be worth more.
      if (best >= 0 && entry.most < entries_[best].prize * (1 - kPrizeRounding)) break;
      const auto known = least_spent_.find(entry.state);
      if (known != least_spent_.end() && known->second < entry.spent) continue;
      const double cost = entry.spent + cost_to_the_end(entry);
      if (cost <= limit_ && beats(entry.prize, cost)) {
        best = index;
        best_cost = cost;
      }
      if (!beats(entry.most, entry.spent + world_.cost_to_end[entry.state.position])) continue;
      expand(index);
      if (entries_.size() > kExactMaxStates || clock_.passed()) return std::nullopt;
    }
    return best < 0 ? std::nullopt : std::optional(unroll(best));
  }

 private:
  struct Entry {
    ExactState state;
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

  // The same for the same set, in whatever order it was visited.
  double prize_of(NodeMask visited) const {
    double prize = 0;
    for (NodeMask rest = visited & ~world_.state.visited; rest != 0; rest &= rest - 1) {
      prize += world_.prizes[std::countr_zero(rest)];
    }
    return prize;
  }

  // With unit prizes whole nodes, else the last one in part.
  double most_from(const ExactState& state, double prize, double spent) const {
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

  // The most comes first, then the deepest, then the cheapest.
  struct ComesLater {
    const std::vector<Entry>& entries;
    bool operator()(int a, int b) const {
      const Entry& one = entries[a];
      const Entry& other = entries[b];
      if (one.most != other.most) return one.most < other.most;
      return one.prize != other.prize ? one.prize < other.prize : one.spent > other.spent;
    }
  };

  void push(const Entry& entry) {
    entries_.push_back(entry);
    open_.push(static_cast<int>(entries_.size()) - 1);
  }

  void expand(int index) {
    const Entry from = entries_[index];
    const ShortestPaths paths = shortest_paths(world_, from.state);
    for (int node = 0; node < std::ssize(world_.nodes); ++node) {
      if ((from.state.visited & bit(node)) != 0) continue;
      if (from.spent + paths.cost[node] + world_.cost_to_end[node] > limit_) continue;
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

  // What it costs to end where the walk must; kNoLimit where it is not there yet.
  double cost_to_the_end(const Entry& entry) const {
    if (world_.end < 0 || world_.end == entry.state.position) return 0;
    if ((entry.state.visited & bit(world_.end)) == 0) return kNoLimit;
    return shortest_paths(world_, entry.state).cost[world_.end];
  }

  // From its last node back to the start.
  std::vector<NodeId> unroll(int index) const {
    std::vector<NodeId> walk;
    const auto go_back = [&](int to, const ExactState& from) {
      const ShortestPaths paths = shortest_paths(world_, from);
      for (int node = to; node != from.position; node = paths.before[node]) walk.push_back(world_.nodes[node]);
    };
    if (world_.end >= 0) go_back(world_.end, entries_[index].state);
    for (; index > 0; index = entries_[index].before) {
      go_back(entries_[index].state.position, entries_[entries_[index].before].state);
    }
    walk.push_back(world_.nodes[world_.state.position]);
    std::reverse(walk.begin(), walk.end());
    return walk;
  }

  Clock clock_;
  SmallWorld world_;
  double limit_;
  bool unit_prizes_;
  std::vector<Arrival> arrivals_;  // by cost per prize
  std::vector<Entry> entries_;
  std::priority_queue<int, std::vector<int>, ComesLater> open_{ComesLater{entries_}};
  std::unordered_map<ExactState, double, ExactStateHash> least_spent_;
};

bool is_plain(const Task& task) {
  return task.ends_anywhere() && !task.has_prizes() && !task.view().open().weighted();
}

}  // namespace

std::size_t nodes_in_reach(const Task& task) {
  return SmallWorld(task).nodes.size();
}

std::optional<double> exact_prize(const Task& task) {
  if (is_plain(task)) {
    const auto best = PlainSearch(task).optimum();
    return best ? std::optional(best->gain + task.prize(task.start())) : std::nullopt;
  }
  auto walk = GeneralSearch(task).walk();
  return walk ? std::optional(plan_of_walk(task, *std::move(walk)).prize) : std::nullopt;
}

std::optional<std::vector<NodeId>> exact_walk(const Task& task, const Clock& clock) {
  return is_plain(task) ? PlainSearch(task, clock).walk() : GeneralSearch(task, clock).walk();
}

}  // namespace graphdrl
