#include "graphdrl/planners/targets.h"

#include <algorithm>
#include <numeric>

namespace graphdrl {
namespace {

using Next = NearestFirst::Next;

constexpr int kMostMet = 32 * Targets::kNearest;  // nodes that a search for the nearest meets; targets may be far apart
constexpr int kMetPerLook = 4096;                 // nodes between two looks at the clock

}  // namespace

Targets::Targets(const Task& task, const Clock& clock) : view_(task.view()) {
  const View& view = task.view();
  const double limit = task.limit();
  numbers_.assign(view.node_count(), -1);
  const auto add = [&](NodeId node, double prize) {
    numbers_[node] = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    prizes_.push_back(prize);
    to_end_.push_back(task.cost_to_end(node));
    total_prize_ += prize;
  };
  const NodeSet visited = task.ground();
  add(task.start(), task.prize(task.start()));
  NearestFirst search;
  search.run_cheapest(view.open(), task.start(), limit, [&](NodeId node, double cost) {
    if (visited.contains(node) || task.prize(node) <= 0 || node == task.end()) return Next::kThrough;
    if (cost + task.cost_to_end(node) <= limit) add(node, task.prize(node));
    return Next::kThrough;
  });
  const bool end_counts = !task.ends_anywhere() && !visited.contains(task.end());
  prizes_.push_back(end_counts ? task.prize(task.end()) : 0);
  total_prize_ += prizes_.back();

  const bool with_table = end() <= kTableTargets;
  if (with_table) table_.assign(nodes_.size() * prizes_.size(), kNoLimit);
  near_ = find_near(view.open(), limit, /*with_costs=*/true, clock);
  if (view.open().directed()) into_ = find_near(view.into(), limit, /*with_costs=*/false, clock);
}

// with_costs: keeps the costs found, of all within the limit where there is a table.
Targets::Lists Targets::find_near(const Graph& graph, double limit, bool with_costs, const Clock& clock) {
  NearestFirst search;
  Lists near{.targets = {}, .begin = {0}};
  const bool fills_table = with_costs && has_table();
  const bool lists_costs = with_costs && !has_table();
  int met_since_look = 0;
  for (int from = 0; from < end(); ++from) {
    double* const costs = fills_table ? row(from) : nullptr;
    if (fills_table) {
      costs[from] = 0;
      costs[end()] = to_end_[from];
    }
    int left = kNearest;
    int met = 0;
    search.run(graph, nodes_[from], limit, [&](NodeId node, double cost) {
      ++met;
      const int target = numbers_[node];
      if (target >= 0) {
        if (left > 0) {
          near.targets.push_back(target);
          if (lists_costs) near_cost_.push_back(cost);
          --left;
        }
        if (fills_table) costs[target] = cost;
      }
      return !fills_table && (left == 0 || met >= kMostMet) ? Next::kEnd : Next::kThrough;
    });
    near.begin.push_back(std::ssize(near.targets));
    met_since_look += met;
    if (met_since_look < kMetPerLook) continue;
    met_since_look = 0;
    if (clock.passed()) complete_ = false;
    if (!complete_) break;
  }
  return near;
}

Targets Targets::after(int first) const {
  Targets rest = *this;
  // The new start takes number 0, the last target the place that it leaves.
  const int last = end() - 1;
  std::vector<int> old(last);  // by new number
  std::iota(old.begin(), old.end(), 0);
  old[0] = first;
  if (first != last) old[first] = last;
  std::vector<int> number(nodes_.size(), -1);
  for (int target = 0; target < last; ++target) number[old[target]] = target;

  rest.numbers_[nodes_[0]] = -1;
  rest.total_prize_ -= prizes_[0] + prizes_[first];
  for (int target = 0; target < last; ++target) {
    rest.numbers_[nodes_[old[target]]] = target;
    rest.nodes_[target] = nodes_[old[target]];
    rest.prizes_[target] = target == 0 ? 0 : prizes_[old[target]];
    rest.to_end_[target] = to_end_[old[target]];
  }
  rest.nodes_.resize(last);
  rest.to_end_.resize(last);
  rest.prizes_.resize(last + 1);
  rest.prizes_[last] = prizes_[end()];
  rest.table_.resize(rest.nodes_.size() * rest.prizes_.size());
  for (int from = 0; from < last; ++from) {
    const double* const all = row(old[from]);
    double* const left = rest.row(from);
    for (int to = 0; to < last; ++to) left[to] = all[old[to]];
    left[last] = all[end()];
  }
  const auto left_of = [&](const Lists& lists) {
    Lists left{.targets = {}, .begin = {0}};
    for (int target = 0; target < last; ++target) {
      for (const int near : lists[old[target]]) {
        if (number[near] >= 0) left.targets.push_back(number[near]);
      }
      left.begin.push_back(std::ssize(left.targets));
    }
    return left;
  };
  rest.near_ = left_of(near_);
  if (!symmetric()) rest.into_ = left_of(into_);
  return rest;
}

double Targets::searched_cost(int from, int to, double most, NearestFirst& search) const {
  if (to == end()) return to_end_[from];
  double found = kNoLimit;
  int searched = 0;
  search.run(view_.open(), nodes_[from], most, [&](NodeId node, double cost) {
    if (node != nodes_[to]) return ++searched < kMostSearched ? Next::kThrough : Next::kEnd;
    found = cost;
    return Next::kEnd;
  });
  return found;
}

double Targets::near_cost(int from, int to) const {
  const auto listed = [&](int at, int other) {
    for (std::int64_t i = near_.begin[at]; i < near_.begin[at + 1]; ++i) {
      if (near_.targets[i] == other) return near_cost_[i];
    }
    return kNoLimit;
  };
  const double cost = listed(from, to);
  return cost == kNoLimit && symmetric() ? listed(to, from) : cost;
}

}  // namespace graphdrl
