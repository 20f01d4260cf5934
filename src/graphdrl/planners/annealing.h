// One chain of the local search.
#pragma once

#include <cstdint>
#include <vector>

#include "graphdrl/planners/moves.h"
#include "graphdrl/planners/tour.h"

namespace graphdrl {

// Simulated annealing over routes [Kirkpatrick, Gelatt and Vecchi 1983]. Each step goes to a random target: ruin, a
// random 2-opt move, recreate, 2-opt from what changed. What comes out is accepted by the rule of Metropolis; its worth
// is its prize, less a price of its cost. Where edges lead one way, nothing is turned round.
class Annealing {
 public:
  // start: its prize and cost do not matter. price: what a unit of cost is worth elsewhere; the best route is then the
  // one worth most after it was paid. 0: nothing, and of routes worth the same the cheapest is best.
  Annealing(const Targets& targets, double limit, std::uint64_t seed, const Tour& start, double price = 0);

  // Goes on from another tour.
  void start(const Tour& tour);

  // Goes on with a child of the route and another one [cross_over()]. The best route up to now is the child.
  // REQUIRES: no step() came before.
  void recombine(const std::vector<int>& other);

  // Whether a route of this prize leaves so much out that it matters more what to visit than in which order. Then steps
  // also move budget between regions, and begin hotter.
  static bool is_selective(const Targets& targets, double prize);

  // One step at so far through the schedule, 0 to 1.
  void step(double progress);

  // The best route up to now.
  const Tour& best();
  // Likewise, but up to the last look at whether the route is the best.
  const Tour& best_seen() const { return best_; }

 private:
  void improve();
  void settle_links();
  bool too_dear() const;
  bool accept(double temperature);
  void remember();

  Draft draft_;
  TwoOpt two_opt_;
  double elsewhere_;        // the price of a unit of cost there
  double price_ = 0;        // likewise, for what is accepted
  std::vector<int> loose_;  // targets whose way on may cost less than is known
  NearestFirst search_;
  std::int64_t steps_ = 0;
  std::int64_t steps_per_look_;  // at whether the route is the best
  Tour best_ = {.order = {}, .links = {}, .prize = -kNoLimit};
};

}  // namespace graphdrl
