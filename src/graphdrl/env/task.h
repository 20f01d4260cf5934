// What a planner is asked: where a walk begins, where it must end, and what it may spend.
#pragma once

#include <vector>

#include "graphdrl/env/view.h"
#include "graphdrl/graph/node_set.h"

namespace graphdrl {

// Where a walk must end: anywhere, where it started, or at a node.
class End {
 public:
  static End anywhere() { return End(kNoNode, false); }
  static End at_start() { return End(kNoNode, true); }
  static End at(NodeId node) { return End(node, false); }

  // The node itself, of a walk from `start`; kNoNode where any will do.
  NodeId of(NodeId start) const { return at_start_ ? start : node_; }

 private:
  End(NodeId node, bool at_start) : node_(node), at_start_(at_start) {}

  NodeId node_;
  bool at_start_;
};

// The most steps of any walk. A budget pays for a multiple of that where edges cost next to nothing; walks stay in
// memory, so they end here. Moves that cost nothing end an episode before [Episode::too_long].
inline constexpr std::int64_t kMaxSteps = 100'000'000;

// Visit what is worth most within a budget. Of walks worth the same, the cheaper one is better.
struct Task {
  View view;
  NodeId start;
  double budget;         // in units of cost
  NodeId end = kNoNode;  // where the walk must end; kNoNode: anywhere
  NodeSet visited = {};  // before, and worth nothing any more: the start among them; empty for the start alone

  double limit() const { return view.spending_limit(budget); }
  bool ends_anywhere() const { return end == kNoNode; }
  NodeSet visited_before() const {
    NodeSet set = visited.empty() ? NodeSet(view.node_count()) : visited;
    set.insert(start);
    return set;
  }
};

// What it costs to get from a node to where a task's walk must end; nothing where it may end anywhere.
class CostToEnd {
 public:
  CostToEnd() = default;
  // Cost: a search of the whole graph, where there is an end.
  explicit CostToEnd(const Task& task);

  double operator()(NodeId node) const { return costs_.empty() ? 0 : costs_[node]; }

 private:
  std::vector<double> costs_;  // [N], or empty
};

// Throws Error where a walk has no place for its start or end: blocked, not in the world, or an end out of reach.
void check(const Task& task);

}  // namespace graphdrl
