// Upper bounds by linear programming over the edges of a graph, and proofs of optimality by branch and cut.
//
// The relaxation is WalkRelaxation's [after Fischetti, Salazar González and Toth 1998]. Branching halves the nodes
// where the walk may end, then decides about visits and edges after short trials both ways; the part with the highest
// bound comes next, so that the bound falls as parts are done, and columns that could not matter any more are fixed by
// their reduced costs.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "graphdrl/planners/plan.h"

namespace graphdrl {

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
