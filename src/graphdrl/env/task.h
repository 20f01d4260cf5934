// What a planner is asked: where a walk begins, where it must end, and what it may spend.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/world.h"
#include "graphdrl/graph/node_set.h"

namespace graphdrl {

// The most steps of any walk. A budget may pay for more where edges cost next to nothing; walks stay in memory, so they
// end here.
inline constexpr std::int64_t kMaxSteps = 100'000'000;

// "25", in units of cost, or "1.1x": floor(1.1 · n + 1e-9) times the mean cost of an edge in a world of n valid nodes.
// Where edges have no costs, a unit is a step.
class Budget {
 public:
  // Units of cost. Throws Error on anything but a number from 0 up; infinity is one.
  explicit Budget(double cost);
  // The same with or without the x.
  static Budget parse(std::string_view text);

  double cost_in(const View& view) const;
  // The same; empty where it depends on the world.
  std::optional<double> cost() const { return relative_ ? std::nullopt : std::optional(value_); }
  const std::string& text() const { return text_; }  // as it was given

 private:
  std::string text_;
  double value_;
  bool relative_ = false;
};

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

// What was asked for. What is not said is what the map's file says, else the default: from the first valid node, to
// anywhere. A budget must come from one of the two.
struct Asked {
  std::optional<Budget> budget = {};
  std::optional<NodeId> start = {};
  std::optional<End> end = {};
};

// What a walk can visit: in reach for the budget, with enough left for the way to the end.
struct Reach {
  std::vector<NodeId> nodes;   // the start first, then nearest first
  std::vector<bool> contains;  // [N]
};

// Visit what is worth most within a budget. Of walks worth the same, the cheaper one is better.
//
// Checked when it is made: a task needs no other check. A value; copies share what was searched for.
class Task {
 public:
  // Throws Error if neither states a budget, and as below.
  Task(const World& world, const Asked& asked);

  // Throws Error on a budget below 0 or not a number, on a start or an end that is blocked or not in the world, and on
  // an end out of reach. Cost: where there is an end, a search of the whole graph.
  Task(View view, NodeId start, double budget, End end = End::anywhere());

  // The same from another start, at no further search unless the end moves with it. Throws Error as above.
  void start_at(NodeId start);

  // The rest of a walk: it stands at a node, has visited a set of nodes and must end where this task's walk does. The
  // nodes visited are its ground, and worth nothing any more.
  // REQUIRES: the end can be reached for the budget.
  Task rest(NodeId position, double budget, NodeSet visited) const;

  // The same budget in a world of which only this is known, and grows. end: kNoNode: anywhere. costs_to_end: [N], kept
  // up to date as more becomes known; null where it may end anywhere.
  Task on(View known, NodeId start, NodeId end, std::shared_ptr<const std::vector<double>> costs_to_end) const;

  // The same, but these nodes are worth nothing: others have claimed them. They are no ground of ours by that.
  Task without(const NodeSet& claimed) const;

  const View& view() const { return view_; }
  NodeId start() const { return start_; }
  NodeId end() const { return end_; }  // kNoNode: anywhere
  bool ends_anywhere() const { return end_ == kNoNode; }
  bool ends_at_start() const { return !ends_anywhere() && asked_end_.of(kNoNode) == kNoNode; }  // wherever that is
  double budget() const { return budget_; }                                                     // units of cost
  // What may be spent in all: the budget with room for the rounding of sums, and at most kMaxSteps mean edges.
  double limit() const { return limit_; }

  // Whether the budget is less than that.
  bool has_budget() const { return has_budget_; }

  // What it costs to get from a node to the end; 0 where any will do, kNoLimit where there is no way.
  double cost_to_end(NodeId node) const { return to_end_ == nullptr ? 0 : (*to_end_)[node]; }

  // Ground: nodes that the walk may go through as often as it likes; the start is one. A first visit makes ground.
  NodeSet ground() const;
  int ground_count() const { return ground_.empty() ? 1 : ground_.count(); }
  // Claimed nodes are worth nothing any more, whoever visited them.
  bool is_claimed(NodeId node) const { return !claimed_.empty() && claimed_.contains(node); }
  // Whether ground and claims are those of the other.
  bool has_sets_of(const Task& other) const { return ground_ == other.ground_ && claimed_ == other.claimed_; }
  // What the first visit of a node is worth, the start among them.
  double prize(NodeId node) const { return is_claimed(node) ? 0 : view_.prize(node); }
  // Whether nodes may be claimed that are no ground.
  bool claims_beyond_ground() const { return claims_beyond_ground_; }
  // Whether first visits may be worth other than 1.
  bool has_prizes() const { return view_.has_prizes() || claims_beyond_ground_; }

  // Searched for when it is first asked for. Any number of threads may ask.
  const Reach& reach() const { return reach_.of(*this); }

 private:
  class LazyReach {
   public:
    LazyReach() = default;
    LazyReach(const LazyReach& other) { *this = other; }
    LazyReach& operator=(const LazyReach& other);
    const Reach& of(const Task& task);
    void forget() { known_ = nullptr; }

   private:
    mutable std::mutex mutex_;
    std::shared_ptr<const Reach> known_;
  };

  void check_reach_from(NodeId start) const;

  View view_;
  End asked_end_;
  NodeId start_;
  NodeId end_;
  double budget_;
  double limit_;
  bool has_budget_;
  std::shared_ptr<const std::vector<double>> to_end_;  // [N]; null where it may end anywhere
  NodeSet ground_ = {};                                // empty for the start alone
  NodeSet claimed_ = {};                               // empty for none
  bool claims_beyond_ground_ = false;
  mutable LazyReach reach_;
};

}  // namespace graphdrl
