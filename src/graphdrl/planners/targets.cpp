#include "graphdrl/planners/targets.h"

#include <algorithm>

namespace graphdrl {
namespace {

using Next = NearestFirst::Next;

// Where targets are few and far between, a search for the nearest looks at so many nodes at most.
constexpr int kMostMet = 32 * Targets::kNearest;

}  // namespace

Targets::Targets(const Task& task, Deadline deadline) : view_(task.view) {
  const View& view = task.view;
  const double limit = task.limit();
  numbers_.assign(view.node_count(), -1);
  const CostToEnd cost_to_end(task);
  const auto add = [&](NodeId node, double prize) {
    numbers_[node] = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    prizes_.push_back(prize);
    to_end_.push_back(cost_to_end(node));
    total_prize_ += prize;
  };
  const NodeSet visited = task.visited_before();
  add(task.start, task.visited.empty() ? view.prize(task.start) : 0);
  NearestFirst search;
  search.run(view.open(), task.start, limit, [&](NodeId node, double cost) {
    if (visited.contains(node) || view.prize(node) <= 0 || node == task.end) return Next::kThrough;
    if (cost + cost_to_end(node) <= limit) add(node, view.prize(node));
    return Next::kThrough;
  });
  const bool end_counts = !task.ends_anywhere() && !visited.contains(task.end);
  prizes_.push_back(end_counts ? view.prize(task.end) : 0);
  total_prize_ += prizes_.back();

  const bool with_table = end() <= kTableTargets;
  if (with_table) table_.assign(nodes_.size() * prizes_.size(), kNoLimit);
  find_near(view.open(), limit, near_, near_begin_, with_table ? nullptr : &near_cost_, deadline);
  if (view.open().directed()) find_near(view.into(), limit, into_, into_begin_, nullptr, deadline);
}

void Targets::find_near(const Graph& graph, double limit, std::vector<int>& near, std::vector<std::int64_t>& begin,
                        std::vector<double>* costs, Deadline deadline) {
  NearestFirst search;
  const bool fills_table = !table_.empty() && &near == &near_;
  begin.assign(1, 0);
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
    if (from % 16 == 0 && passed(deadline)) complete_ = false;
    if (!complete_) break;
  }
}

double Targets::searched_cost(int from, int to, double most, NearestFirst& search) const {
  if (to == end()) return to_end_[from];
  double found = kNoLimit;
  search.run(view_.open(), nodes_[from], most, [&](NodeId node, double cost) {
    if (node != nodes_[to]) return Next::kThrough;
    found = cost;
    return Next::kEnd;
  });
  return found;
}

double Targets::near_cost(int from, int to) const {
  for (std::int64_t i = near_begin_[from]; i < near_begin_[from + 1]; ++i) {
    if (near_[i] == to) return near_cost_[i];
  }
  return kNoLimit;
}

}  // namespace graphdrl
