// A task as an orienteering problem [Golden, Levy and Vohra 1987]: targets with prizes, and the costs between them.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Target 0 is the start. Then come the unvisited nodes that are worth something and from which, once visited, the end
// can still be reached. The end is the last, even where the walk may end anywhere. Costs are those of cheapest ways. Up
// to kTableTargets targets a table holds them all; beyond, a target knows those of its nearest targets only.
class Targets {
 public:
  static constexpr int kNearest = 24;         // to try when a target is put into a walk: see docs/search.md
  static constexpr int kTableTargets = 2000;  // a table of 32 MB

  // Cost: a search from every target; with a table of all within the limit, else up to the nearest targets. Gives up
  // once the clock passes [complete()].
  explicit Targets(const Task& task, const Clock& clock = {});

  // The targets left once a walk has gone to `first`, which becomes the start; the old start is dropped.
  // REQUIRES: there is a table; `first` is neither the start nor the end.
  Targets after(int first) const;

  bool complete() const { return complete_; }
  // Whether no way through other targets is cheaper than the cost known: everywhere but in a complete graph whose costs
  // are not metric.
  bool metric() const { return view_.open().straight_ways_suffice(); }
  bool symmetric() const { return into_.begin.empty(); }
  int end() const { return static_cast<int>(nodes_.size()); }  // the number of the end, and the count of the others
  NodeId node(int target) const { return nodes_[target]; }
  int target_of(NodeId node) const { return numbers_[node]; }  // -1 if the node is no target, or the end
  double prize(int target) const { return prizes_[target]; }
  double total_prize() const { return total_prize_; }  // of all, the start and the end included

  // The nearest targets, and those it is nearest from, which are the same where edges lead both ways. Nearest first.
  std::span<const int> near(int target) const { return near_[target]; }
  std::span<const int> into(int target) const { return symmetric() ? near_[target] : into_[target]; }

  // From a target other than the end to another; kNoLimit where it is not known or no way exists.
  double cost(int from, int to) const {
    if (!table_.empty()) return row(from)[to];
    return to == end() ? to_end_[from] : near_cost(from, to);
  }
  // The same, searched for in the graph; kNoLimit above `most` or beyond the kMostSearched nearest nodes. Cost: the
  // nodes that are nearer.
  static constexpr int kMostSearched = 4096;  // more than worlds of 60x60 have: longer ways keep their upper bound
  double searched_cost(int from, int to, double most, NearestFirst& search) const;

  bool has_table() const { return !table_.empty(); }

 private:
  struct Lists {                      // of targets
    std::vector<int> targets;         // [T, at most kNearest]
    std::vector<std::int64_t> begin;  // [T + 1]

    std::span<const int> operator[](int target) const {
      return {targets.data() + begin[target], targets.data() + begin[target + 1]};
    }
  };
  // [T + 1], in the table.
  const double* row(int from) const { return table_.data() + static_cast<std::size_t>(from) * prizes_.size(); }
  double* row(int from) { return table_.data() + static_cast<std::size_t>(from) * prizes_.size(); }
  double near_cost(int from, int to) const;
  Lists find_near(const Graph& graph, double limit, bool with_costs, const Clock& clock);

  View view_;
  std::vector<NodeId> nodes_;   // [T]
  std::vector<int> numbers_;    // [N]
  std::vector<double> prizes_;  // [T + 1]
  std::vector<double> to_end_;  // [T]
  Lists near_;
  std::vector<double> near_cost_;  // as near_.targets; without a table only
  Lists into_;                     // of directed graphs
  std::vector<double> table_;      // [T, T + 1], or empty
  double total_prize_ = 0;
  bool complete_ = true;
};

}  // namespace graphdrl
