// Upper bounds on what any walk can be worth: how far from the optimum a plan may be at most.
//
// Four relaxations, of which the least counts:
// - Arrivals. Every node visited is arrived at at least once, by an edge of the biconnected block that joins it to the
//   start. Leaving a block through its entry node costs one more arrival there. So in the tree of blocks, what hangs
//   from a node costs its cheapest arrivals, plus one at the node for every block that the walk does not end in. A
//   dead end is a block of two nodes: both ways are paid. What is cheapest for its prize comes first, whatever has to
//   be visited before it, and the last one in part (a fractional knapsack [Dantzig 1957]). Cost: O(n log² n).
// - The same as an exact knapsack over the tree, the least cost for every number of nodes: tighter, and quadratic at
//   worst. Where all prizes are 1, and while it takes kKnapsackSums sums at most.
// - Colours. In a bipartite graph a walk's nodes alternate in colour, so neither colour has more than its half.
// - Order. In a directed graph a strongly connected component that was left is not entered again.
// The bound holds for directed and weighted graphs, and for walks that must end somewhere; what cannot be reached, and
// left for the end, within the budget counts for nothing.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "graphdrl/planners/plan.h"

namespace graphdrl {

inline constexpr double kKnapsackSums = 2e8;

// No walk has a higher prize [Plan::prize]. Once the clock passes, only the sum of prizes, colours and order count.
double max_prize(const Task& task, const Clock& clock = {});

// Linear programs over the edges of a graph, and proofs of optimality by branch and cut.
//
// The relaxation is WalkRelaxation's [after Fischetti, Salazar González and Toth 1998]. Branching halves the nodes
// where the walk may end, then decides about visits and edges after short trials both ways; the part with the highest
// bound comes next, so that the bound falls as parts are done, and columns that could not matter any more are fixed by
// their reduced costs.
class LpBound {
 public:
  virtual ~LpBound() = default;

  // Until when to work: a clock, and so much work [LinearProgram::work(), and flows likewise]. Without a deadline the
  // result depends on the work alone.
  struct Effort {
    Clock clock = {};
    double work = kNoLimit;
  };

  // Adds cutting planes to the relaxation of all walks while that helps. prize: of the best walk known.
  virtual void cut(double prize, Effort effort) = 0;
  // Goes on from there by branching, until a walk is optimal or the effort is spent.
  virtual void branch(double prize, Effort effort) = 0;

  // At least every prize passed in. No walk has a higher prize; where prizes have no common step, one may exceed it by
  // kBoundMargin, relative.
  static constexpr double kBoundMargin = 1e-9;
  virtual double bound() const = 0;
  // A walk that branching found, better than any it was told of, or empty.
  virtual const std::vector<NodeId>& walk() const = 0;
};

// bound: one known. Null where the graph has too many edges, or in a build without CLP.
std::unique_ptr<LpBound> make_lp_bound(const Task& task, double bound);

// Puts the bound and the walk, where it has one, into a plan that is not as good.
inline void improve(const LpBound& lp, const Task& task, Plan& plan) {
  const double bound = std::min(plan.bound, lp.bound());
  if (!lp.walk().empty()) plan = better_of(std::move(plan), plan_of_walk(task, lp.walk()));
  plan.settle(bound);
}

// Whether this build has CLP.
bool has_lp_bound();

}  // namespace graphdrl
