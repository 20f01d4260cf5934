#include "graphdrl/planners/exact.h"

#include <fmt/format.h>

#include "graphdrl/planners/bound.h"

namespace graphdrl {
namespace {

constexpr double kSearchShare = 0.5;     // of the time left, for the search
constexpr double kIncumbentShare = 0.1;  // likewise, for a walk to begin branch and cut with

}  // namespace

Plan ExactPlanner::plan(const Task& task, const Clock& clock) {
  if (auto walk = exact_walk(task, clock.share(kSearchShare))) {
    return plan_of_walk(task, *std::move(walk), /*optimal=*/true);
  }
  const bool ends_early = clock.has_deadline() || clock.stopped();
  const auto lp = make_lp_bound(task, kNoLimit);
  if (lp != nullptr || ends_early) {
    const Clock until = lp == nullptr ? clock : clock.share(kIncumbentShare);
    Plan best = incumbent_->plan(task, until);
    if (best.optimal) return best;
    if (lp != nullptr) {
      const LpBound::Effort effort{.clock = clock, .work = clock.has_deadline() ? kNoLimit : kExactMaxWork};
      lp->cut(best.prize, effort);
      lp->branch(best.prize, effort);
      improve(*lp, task, best);
    }
    if (best.optimal || ends_early || clock.stopped()) return best;
  }
  const std::size_t reached = nodes_in_reach(task);
  const bool many = reached > kExactMaxNodes;
  throw SearchOutOfReach(
      {.what = "exact search is out of reach",
       .expected = fmt::format("at most {} nodes in reach and {} states{}", kExactMaxNodes, kExactMaxStates,
                               has_lp_bound() ? ", or a proof by branch and cut" : ""),
       .got =
           many ? fmt::format("more than {} nodes", kExactMaxNodes) : fmt::format("{} nodes, too many states", reached),
       .where = task.view().name()});
}

}  // namespace graphdrl
