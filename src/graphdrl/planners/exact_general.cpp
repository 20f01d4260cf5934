#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>

#include "graphdrl/planners/exact_search.h"

namespace graphdrl {
namespace {

class GeneralSearch {
 public:
  explicit GeneralSearch(const Task& task, const Clock& clock = {});

  // The best walk; empty where it is out of reach, or late.
  std::optional<std::vector<NodeId>> walk();

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

  double prize_of(NodeMask visited) const;
  double most_from(const ExactState& state, double prize, double spent) const;

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

  Clock clock_;
  SmallWorld world_;
  double limit_;
  bool unit_prizes_;
  std::vector<Arrival> arrivals_;  // by cost per prize
  std::vector<Entry> entries_;
  std::vector<int> heap_;
  std::unordered_map<ExactState, double, ExactStateHash> least_spent_;
};

GeneralSearch::GeneralSearch(const Task& task, const Clock& clock)
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

// The same for the same set, in whatever order it was visited.
double GeneralSearch::prize_of(NodeMask visited) const {
  double prize = 0;
  for (NodeMask rest = visited & ~world_.state.visited; rest != 0; rest &= rest - 1) {
    prize += world_.prizes[std::countr_zero(rest)];
  }
  return prize;
}

// With unit prizes whole nodes, else the last one in part.
double GeneralSearch::most_from(const ExactState& state, double prize, double spent) const {
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

void append_path(const SmallWorld& world, const ShortestPaths& paths, int from, int to, std::vector<NodeId>& walk) {
  const auto first = std::ssize(walk);
  for (int node = to; node != from; node = paths.before[node]) walk.push_back(world.nodes[node]);
  std::reverse(walk.begin() + first, walk.end());
}

// What it costs to end where the walk must; kNoLimit where it is not there yet.
double GeneralSearch::cost_to_the_end(const Entry& entry) const {
  if (world_.end < 0 || world_.end == entry.state.position) return 0;
  if ((entry.state.visited & bit(world_.end)) == 0) return kNoLimit;
  return shortest_paths(world_, entry.state).cost[world_.end];
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

std::optional<std::vector<NodeId>> GeneralSearch::walk() {
  if (!world_.fits()) return std::nullopt;
  push({.state = world_.state, .spent = 0, .prize = 0, .most = most_from(world_.state, 0, 0), .before = -1});
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
    // Nothing left in the heap can be worth more.
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
  if (best < 0) return std::nullopt;
  return unroll(best);
}

std::vector<NodeId> GeneralSearch::unroll(int index) const {
  std::vector<int> chain;
  for (int i = index; i > 0; i = entries_[i].before) chain.push_back(i);
  std::reverse(chain.begin(), chain.end());
  std::vector<NodeId> walk = {world_.nodes[world_.state.position]};
  for (const int next : chain) {
    const Entry& from = entries_[entries_[next].before];
    append_path(world_, shortest_paths(world_, from.state), from.state.position, entries_[next].state.position, walk);
  }
  const Entry& last = entries_[index];
  if (world_.end >= 0) {
    append_path(world_, shortest_paths(world_, last.state), last.state.position, world_.end, walk);
  }
  return walk;
}

}  // namespace

std::optional<std::vector<NodeId>> general_exact_walk(const Task& task, const Clock& clock) {
  return GeneralSearch(task, clock).walk();
}

}  // namespace graphdrl
