#include "graphdrl/planners/bound.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "graphdrl/graph/components.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {
namespace {

// The tree of blocks, with what it costs to arrive in them.
struct ArrivalTree {
  ArrivalTree(const Task& task) : blocks(task.view().both_ways(), task.start(), task.reach().contains) {
    const Graph& into = task.view().into();
    std::vector<int> block_of(task.view().node_count(), -1);
    std::vector<bool> end_below(task.view().node_count());
    if (!task.ends_anywhere()) end_below[task.end()] = true;
    for (int block = 0; block < blocks.count(); ++block) {
      const NodeId root = blocks.root(block);
      const auto members = blocks.members(block);
      block_of[root] = block;
      for (const NodeId member : members) block_of[member] = block;
      const auto cheapest = [&](NodeId node) {
        double least = kNoLimit;
        const auto from = into.neighbours(node);
        for (int i = 0; i < std::ssize(from); ++i) {
          if (block_of[from[i]] == block) least = std::min(least, into.cost(node, i));
        }
        return least;
      };
      for (const NodeId member : members) arrival.push_back(cheapest(member));
      back.push_back(cheapest(root));
      holds_end.push_back(std::any_of(members.begin(), members.end(), [&](NodeId node) { return end_below[node]; }));
      if (holds_end.back()) end_below[root] = true;
    }
  }

  Blocks blocks;
  std::vector<double> arrival;  // by place among the blocks' members: the cheapest edge of its block into a member
  std::vector<double> back;     // [blocks], likewise into the root; kNoLimit where there is none
  std::vector<bool> holds_end;  // [blocks], where the walk must end: in it, or in what hangs from it
};

// Something to pay for, by cost per prize; a heap has the cheapest on top.
struct Item {
  double cost;
  double prize;
  bool operator<(const Item& other) const { return cost * other.prize > other.cost * prize; }
};
using Items = std::priority_queue<Item>;

// Puts all of one heap into the other, the smaller into the larger.
void merge(Items& into, Items& from) {
  if (into.size() < from.size()) std::swap(into, from);
  for (; !from.empty(); from.pop()) into.push(from.top());
}

// The first relaxation of bound.h.
double fractional_bound(const Task& task, const ArrivalTree& tree) {
  std::vector<Items> hanging(task.view().node_count());        // what hangs from a node
  std::vector<double> deepest(task.view().node_count(), 0.0);  // the most that not coming back from there can save
  for (int block = 0; block < tree.blocks.count(); ++block) {
    Items items;
    double saved = 0;
    const auto members = tree.blocks.members(block);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double prize = task.prize(members[i]);
      if (prize > 0) items.push({tree.arrival[tree.blocks.first_member(block) + i], prize});
      merge(items, hanging[members[i]]);
      saved = std::max(saved, deepest[members[i]]);
    }
    const NodeId root = tree.blocks.root(block);
    const double back = tree.back[block] == kNoLimit ? 0 : tree.back[block];
    if (!tree.holds_end[block] && !items.empty()) {
      // Whatever is had here pays the way back: spread over the items for which that is cheapest.
      Item whole{back, 0};
      while (!items.empty() && (whole.prize == 0 || whole < items.top())) {
        whole.cost += items.top().cost;
        whole.prize += items.top().prize;
        items.pop();
      }
      items.push(whole);
    }
    if (task.ends_anywhere()) deepest[root] = std::max(deepest[root], saved + back);
    merge(hanging[root], items);
  }
  double left = task.limit() + deepest[task.start()];
  double prize = task.prize(task.start());
  Items& items = hanging[task.start()];
  for (; !items.empty() && left >= 0; items.pop()) {
    const Item& item = items.top();
    prize += item.cost <= left ? item.prize : item.prize * left / item.cost;
    left -= item.cost;
  }
  return prize;
}

// Least costs by number of nodes visited, from 0 up; kNoLimit where so many cannot be had.
using Costs = std::vector<double>;

// A branch of the tree of blocks, seen from the node it hangs from, which is not counted.
struct Branch {
  Costs closed = {0};  // the walk comes back
  Costs open = {0};    // the walk ends there, if it can
};

// The second relaxation of bound.h.
class Knapsack {
 public:
  Knapsack(const Task& task, const ArrivalTree& tree, const Clock& clock)
      : task_(task), tree_(tree), clock_(clock), hanging_(task.view().node_count()) {}

  // Nodes besides the start that can be had within the limit; empty where that takes too long to find out.
  std::optional<int> most_visited() {
    for (int block = 0; block < tree_.blocks.count(); ++block) {
      close_block(block);
      if (sums_ > kKnapsackSums || clock_.passed()) return std::nullopt;
    }
    const auto& all = hanging_[task_.start()];
    if (!all) return 0;
    return static_cast<int>((task_.end() == task_.start() ? all->closed : all->open).size()) - 1;
  }

 private:
  // The least cost to visit k nodes in two independent parts together, for every k that the limit allows.
  Costs convolution(const Costs& one, const Costs& other) {
    sums_ += static_cast<double>(one.size()) * static_cast<double>(other.size());
    if (sums_ > kKnapsackSums) return {0};  // too long: given up
    Costs sum(one.size() + other.size() - 1, kNoLimit);
    for (std::size_t i = 0; i < one.size(); ++i) {
      if (one[i] > task_.limit()) continue;
      for (std::size_t j = 0; j < other.size(); ++j) sum[i + j] = std::min(sum[i + j], one[i] + other[j]);
    }
    while (sum.back() > task_.limit()) sum.pop_back();  // k = 0 costs nothing
    return sum;
  }

  // Adds a branch beside another: the walk ends in one of them at most.
  void add_beside(Branch& branch, const Branch& other) {
    Costs open = convolution(branch.open, other.closed);
    const Costs ends_in_other = convolution(branch.closed, other.open);
    if (open.size() < ends_in_other.size()) open.resize(ends_in_other.size(), kNoLimit);
    for (std::size_t i = 0; i < ends_in_other.size(); ++i) open[i] = std::min(open[i], ends_in_other[i]);
    branch.open = std::move(open);
    branch.closed = convolution(branch.closed, other.closed);
  }

  Costs behind(const Costs& costs, double arrival) {
    sums_ += static_cast<double>(costs.size());
    Costs result = {0};
    for (const double cost : costs) result.push_back(arrival + cost);
    return result;
  }

  // Adds a block, and what hangs from its members, to what hangs from its root.
  void close_block(int block) {
    // Members from which nothing hangs: the cheapest first. Sums of sorted costs are convex, so they go in at once.
    std::vector<double> plain;
    Branch whole;
    const auto members = tree_.blocks.members(block);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double arrival = tree_.arrival[tree_.blocks.first_member(block) + i];
      if (const std::optional<Branch> branch = std::exchange(hanging_[members[i]], std::nullopt)) {
        add_beside(whole, {behind(branch->closed, arrival), behind(branch->open, arrival)});
      } else {
        plain.push_back(arrival);
      }
    }
    std::sort(plain.begin(), plain.end());
    Costs sums = {0};
    for (const double cost : plain) {
      if (sums.back() + cost > task_.limit()) break;
      sums.push_back(sums.back() + cost);
    }
    add_beside(whole, {sums, sums});
    for (std::size_t k = 1; k < whole.closed.size(); ++k) whole.closed[k] += tree_.back[block];
    // A walk that must end elsewhere comes back.
    if (!task_.ends_anywhere() && !tree_.holds_end[block]) whole.open = whole.closed;
    auto& beside = hanging_[tree_.blocks.root(block)];
    if (beside) {
      add_beside(*beside, whole);
    } else if (whole.open.size() > 1) {
      beside = std::move(whole);
    }
  }

  const Task& task_;
  const ArrivalTree& tree_;
  Clock clock_;
  double sums_ = 0;
  std::vector<std::optional<Branch>> hanging_;  // [N], what hangs from a node, away from the start
};

// What a walk of so many steps can be worth at most in a bipartite graph; kNoLimit where it is not bipartite.
double colour_bound(const Task& task, double steps) {
  std::vector<std::int8_t> colour(task.view().node_count(), -1);
  const Graph& graph = task.view().both_ways();
  colour[task.start()] = 0;
  std::vector<NodeId> queue = {task.start()};
  std::vector<double> prizes[2];
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const NodeId node = queue[head];
    prizes[colour[node]].push_back(task.prize(node));
    for (const NodeId next : graph.neighbours(node)) {
      if (!task.reach().contains[next]) continue;
      if (colour[next] == colour[node]) return kNoLimit;
      if (colour[next] >= 0) continue;
      colour[next] = static_cast<std::int8_t>(1 - colour[node]);
      queue.push_back(next);
    }
  }
  const auto positions = static_cast<std::int64_t>(std::min(steps, 4e18)) + 1;
  const auto best = [](std::vector<double>& of, std::int64_t count) {
    if (count < std::ssize(of)) {
      std::nth_element(of.begin(), of.begin() + count, of.end(), std::greater<>());
      of.resize(static_cast<std::size_t>(count));
    }
    return std::accumulate(of.begin(), of.end(), 0.0);
  };
  return best(prizes[0], (positions + 1) / 2) + best(prizes[1], positions / 2);
}

// The best way through the strongly connected components of a directed graph.
double order_bound(const Task& task) {
  const Graph& open = task.view().open();
  const std::vector<int> component = strong_components(open, task.start(), task.reach().contains);
  const int count = 1 + *std::max_element(component.begin(), component.end());
  std::vector<std::vector<NodeId>> members(count);
  for (const NodeId node : task.reach().nodes) {
    if (component[node] >= 0) members[component[node]].push_back(node);
  }
  std::vector<double> best(count, 0.0);  // of ways that end in a component, without what it is worth itself
  double most = 0;
  for (int c = 0; c < count; ++c) {
    double here = best[c];
    for (const NodeId node : members[c]) here += task.prize(node);
    most = std::max(most, here);
    for (const NodeId node : members[c]) {
      for (const NodeId next : open.neighbours(node)) {
        const int other = component[next];
        if (other > c) best[other] = std::max(best[other], here);
      }
    }
  }
  return most;
}

}  // namespace

double max_prize(const Task& task, const Clock& clock) {
  const Graph& open = task.view().open();
  double most = 0;
  for (const NodeId node : task.reach().nodes) most += task.prize(node);
  const double steps = open.min_cost() > 0 ? std::floor(task.limit() / open.min_cost() * (1 + 1e-12)) : kNoLimit;
  most = std::min(most, colour_bound(task, steps));
  if (open.directed()) most = std::min(most, order_bound(task));
  if (clock.passed()) return most;
  const ArrivalTree tree(task);
  most = std::min(most, fractional_bound(task, tree));
  if (task.has_prizes()) return most * (1 + kPrizeRounding);
  most = std::floor(most + 1e-9);
  if (clock.passed()) return most;
  if (const auto nodes = Knapsack(task, tree, clock).most_visited()) {
    most = std::min(most, *nodes + task.prize(task.start()));  // what was visited before counts again at worst
  }
  return most;
}

}  // namespace graphdrl
