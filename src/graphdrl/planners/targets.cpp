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
  find_near(view.open(), limit, near_, near_begin_, with_table ? nullptr : &near_cost_, clock);
  if (view.open().directed()) find_near(view.into(), limit, into_, into_begin_, nullptr, clock);
}

void Targets::find_near(const Graph& graph, double limit, std::vector<int>& near, std::vector<std::int64_t>& begin,
                        std::vector<double>* costs, const Clock& clock) {
  NearestFirst search;
  const bool fills_table = !table_.empty() && &near == &near_;
  begin.assign(1, 0);
  int met_since_look = 0;
  for (int from = 0; from < end(); ++from) {
    double* const row = fills_table ? table_.data() + static_cast<std::size_t>(from) * prizes_.size() : nullptr;
    if (row != nullptr) {
      row[from] = 0;
      row[end()] = to_end_[from];
    }
    int left = kNearest;
    int met = 0;
    search.run(graph, nodes_[from], limit, [&](NodeId node, double cost) {
      ++met;
      const int target = numbers_[node];
      if (target >= 0) {
        if (left > 0) {
          near.push_back(target);
          if (costs != nullptr) costs->push_back(cost);
          --left;
        }
        if (row != nullptr) row[target] = cost;
      }
      return row == nullptr && (left == 0 || met >= kMostMet) ? Next::kEnd : Next::kThrough;
    });
    begin.push_back(std::ssize(near));
    met_since_look += met;
    if (met_since_look < kMetPerLook) continue;
    met_since_look = 0;
    if (clock.passed()) complete_ = false;
    if (!complete_) return;
  }
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
    double* const left = rest.table_.data() + static_cast<std::size_t>(from) * rest.prizes_.size();
    for (int to = 0; to < last; ++to) left[to] = all[old[to]];
    left[last] = all[end()];
  }
  const auto take_lists = [&](const std::vector<int>& lists, const std::vector<std::int64_t>& begin,
                              std::vector<int>& rest_lists, std::vector<std::int64_t>& rest_begin) {
    rest_lists.clear();
    rest_begin.assign(1, 0);
    for (int target = 0; target < last; ++target) {
      for (const int near : list(lists, begin, old[target])) {
        if (number[near] >= 0) rest_lists.push_back(number[near]);
      }
      rest_begin.push_back(std::ssize(rest_lists));
    }
  };
  take_lists(near_, near_begin_, rest.near_, rest.near_begin_);
  if (!symmetric()) take_lists(into_, into_begin_, rest.into_, rest.into_begin_);
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
  for (std::int64_t i = near_begin_[from]; i < near_begin_[from + 1]; ++i) {
    if (near_[i] == to) return near_cost_[i];
  }
  if (!symmetric()) return kNoLimit;
  for (std::int64_t i = near_begin_[to]; i < near_begin_[to + 1]; ++i) {
    if (near_[i] == from) return near_cost_[i];
  }
  return kNoLimit;
}

}  // namespace graphdrl
