// One chain of the local search.
#pragma once

#include <cstdint>
#include <vector>

#include "graphdrl/planners/moves.h"

namespace graphdrl {

// Simulated annealing over routes [Kirkpatrick, Gelatt and Vecchi 1983]. Each step goes to a random target: ruin, a
// random 2-opt move, recreate, 2-opt from what changed. What comes out is accepted by the rule of Metropolis; its worth
// is its prize, less a price of its cost. Where edges lead one way, nothing is turned round.
class Annealing {
 public:
  Annealing(const Targets& targets, double limit, std::uint64_t seed, const AnnealingOptions& options = {});

  // Starts with a route: targets in order, and what the ways to each of them and to the end cost.
  void start(const std::vector<int>& order, const std::vector<double>& links);

  // Goes on with a child of the route and another one [cross_over()]. The best route up to now is the child.
  // REQUIRES: start() came before, and no step().
  void recombine(const std::vector<int>& other);

  // Whether a route of this prize leaves so much out that it matters more what to visit than in which order. Then steps
  // also move budget between regions, and begin hotter.
  static bool is_selective(const Targets& targets, double prize, const AnnealingOptions& options = {});

  // One step at so far through the schedule, 0 to 1. REQUIRES: start() came before.
  void step(double progress);

  // The best route up to now: its targets in order. What follows is of it, once it was called.
  const std::vector<int>& best();
  const std::vector<double>& best_links() const { return best_links_; }  // the costs of the ways, as for start()
  double best_prize() const { return best_prize_; }
  double best_cost() const { return best_cost_; }
  int best_visits() const { return static_cast<int>(best_.size()); }

 private:
  void improve();
  void settle_links();
  bool too_dear() const;
  bool accept(double temperature);
  void remember();

  Draft draft_;
  TwoOpt two_opt_;
  double price_ = 0;        // of a unit of cost
  std::vector<int> loose_;  // targets whose way on may cost less than is known
  NearestFirst search_;
  std::int64_t steps_ = 0;
  std::int64_t steps_per_look_;  // at whether the route is the best
  std::vector<int> best_;
  std::vector<double> best_links_;
  double best_prize_ = -1;
  double best_cost_ = 0;
};

}  // namespace graphdrl
