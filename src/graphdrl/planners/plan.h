// Planners, which think out a whole walk before its first step is taken, and the plans they make.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "graphdrl/base/clock.h"
#include "graphdrl/env/exploration.h"
#include "graphdrl/env/task.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

inline constexpr double kPrizeRounding = 1e-12;  // relative, of sums of the same prizes in another order
inline constexpr double kBoundRounding = 1e-11;  // relative: a walk worth as much as that meets a bound

// Whether no walk that keeps to a bound is worth more, but for rounding.
inline bool meets(double prize, double bound) {
  return prize >= bound * (1 - kBoundRounding);
}

struct Plan {
  std::vector<NodeId> walk;  // every step, the start first
  int visited = 0;           // valid nodes, those before the walk among them
  double prize = 0;          // of the nodes first visited on the walk, and of its start where that is new
  double cost = 0;
  double bound = std::numeric_limits<double>::infinity();  // no walk has a higher prize
  bool optimal = false;                                    // proved so: no walk has a higher prize

  // Takes a bound in: the least counts, and a plan that meets it is optimal.
  void settle(double other_bound);
};

// Whether one plan is better: by prize, then by cost.
bool better(const Plan& one, const Plan& other);

// The better one; of two as good the one that is proved optimal, else the first.
Plan better_of(Plan first, Plan second);

// The plan that a walk is: what it visits, is worth and costs. A repeated node is a blocked move and costs 1. Cost:
// O(steps). REQUIRES: every other step follows an edge.
Plan plan_of_walk(const Task& task, std::vector<NodeId> walk, bool optimal = false);

// Whether a walk, its start first, follows edges to where the task must end, and can be paid for. REQUIRES: it has
// a start.
bool can_walk(const Task& task, std::span<const NodeId> walk);

// Answers tasks. Keeps scratch memory: one thread at a time.
class Planner {
 public:
  virtual ~Planner() = default;

  // The best walk it finds. Once the clock passes, the best walk so far, which ends where the task says; the walk of
  // the start alone where there is nothing else. Throws Error on a task that it cannot answer.
  virtual Plan plan(const Task& task, const Clock& clock = {}) = 0;

  // The same, never worse than a plan of the same task that is known already; a search begins with it.
  virtual Plan plan_from(const Task& task, Plan known, const Clock& clock = {});

  // Whether its plans have a bound beside them.
  virtual bool bounds() const { return false; }
};

// The walk that makes these first visits one after the other, each by the cheapest way through visited ground.
// Goes on to where the task says it must end. REQUIRES: there are such ways.
std::vector<NodeId> walk_through(const Task& task, std::span<const NodeId> first_visits, NearestFirst& search);

// Appends the cheapest way from a walk's last node to another. REQUIRES: there is one.
void append_way_to(const View& view, NodeId node, std::vector<NodeId>& walk, NearestFirst& search);

// Likewise to where the task says that it must end, if anywhere.
void append_way_to_end(const Task& task, std::vector<NodeId>& walk, NearestFirst& search);

}  // namespace graphdrl
