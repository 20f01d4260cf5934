// An exploration under way, and the moves it has: first visits.
#pragma once

#include "graphdrl/env/observation.h"
#include "graphdrl/env/task.h"
#include "graphdrl/graph/node_set.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// A move: a walk to a node that is no ground yet but next to it, by the cheapest way through ground.
struct FirstVisit {
  NodeId node = kNoNode;  // kNoNode: there is none
  double cost = 0;        // in units of cost
};

// Where a walk stands, what ground it has, and what it may still spend. It refers to a task and to a set of ground,
// which must outlive it. Searches, networks and baselines take their first visits from here.
class Exploration {
 public:
  // At the start of a task. ground: task.ground().
  Exploration(const Task& task, const NodeSet& ground)
      : Exploration(task, ground, task.ground_count(), task.start(), task.limit()) {}
  // Of an episode. ground: now.ground().
  Exploration(const Observation& now, const NodeSet& ground)
      : Exploration(*now.task, ground, now.visited_count, now.position, now.spendable) {}
  Exploration(const Task& task, NodeSetView ground, int ground_count, NodeId position, double spendable)
      : task_(&task), ground_(ground), ground_count_(ground_count), position_(position), spendable_(spendable) {}

  const Task& task() const { return *task_; }
  const View& view() const { return task_->view(); }
  const NodeSetView& ground() const { return ground_; }
  int ground_count() const { return ground_count_; }
  // Whether a first visit of the node is still to be made by anybody.
  bool is_new(NodeId node) const { return !ground_.contains(node) && !task_->is_claimed(node); }
  // How many nodes are. Cost: O(1), or O(N) where others have claimed some.
  int new_count() const;
  NodeId position() const { return position_; }
  double spendable() const { return spendable_; }  // in units of cost
  // What is left to spend beyond the way to the end.
  double free_to_spend() const { return spendable_ - task_->cost_to_end(position_); }

  // Calls visit(node, cost) for every first visit that can be paid for with the way to the end, nearest first; goes on
  // while it gives true. Before that calls meet(cost) for every node that the search meets, and ends where that gives
  // false. Cost: what is nearer than the last first visit.
  template <typename Visit, typename Meet>
  void for_first_visits(NearestFirst& search, const Visit& visit, const Meet& meet) const {
    using Next = NearestFirst::Next;
    search.run(view().open(), position_, spendable_, [&](NodeId node, double cost) {
      if (!meet(cost)) return Next::kEnd;
      if (ground_.contains(node)) return Next::kThrough;
      if (cost + task_->cost_to_end(node) > spendable_) return Next::kPast;
      return visit(node, cost) ? Next::kPast : Next::kEnd;
    });
  }
  FirstVisit nearest_first_visit(NearestFirst& search) const;

  // Makes a first visit. REQUIRES: ground is the set that this refers to.
  void make(const FirstVisit& visit, NodeSet& ground);

 private:
  const Task* task_;
  NodeSetView ground_;
  int ground_count_;
  NodeId position_;
  double spendable_;
};

// Looks for the cheapest way through ground from a node to another, which need be no ground itself. False if there is
// none. search.append_path_to(goal, walk) appends it. REQUIRES: from != goal.
bool find_way(const Graph& open, NodeId from, NodeId goal, const NodeSetView& ground, NearestFirst& search);

// What an unvisited node is likely to cost on top of one step, in mean edges, by its unvisited neighbours: one without
// any must be left again by the way one came; one with a single neighbour is a dead end. Of fourteen pairs of penalties
// tried, the one by which a beam visits most on random 11×11 mazes at 1.0x.
inline constexpr double kIsolatedPenalty = 4;
inline constexpr double kDeadEndPenalty = 2;

inline double leftover_penalty(int unvisited_neighbours) {
  return unvisited_neighbours == 0 ? kIsolatedPenalty : unvisited_neighbours == 1 ? kDeadEndPenalty : 0.0;
}

// By how much the sum of penalties over all unvisited nodes changes when `node` is visited: by -kIsolatedPenalty at
// least. Cost: O(degrees around it).
double change_of_penalties(const View& view, const NodeSetView& ground, NodeId node);

// How many unvisited neighbours a node has, as far as its penalty goes: more than two count as three.
inline int unvisited_neighbours_up_to_three(const View& view, const NodeSetView& ground, NodeId node) {
  int count = 0;
  for (const NodeId next : view.open_neighbours(node)) {
    count += !ground.contains(next);
    if (count > 2) break;
  }
  return count;
}

}  // namespace graphdrl
