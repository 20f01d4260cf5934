// One chain of the local search.
#pragma once

#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/planners/route.h"
#include "graphdrl/planners/targets.h"

namespace graphdrl {

// Simulated annealing over routes. Each step goes to a random target. It takes up to two strings of the route's targets
// near it out, turns a part of the route round there, puts what fits back at its cheapest place, in random order, and
// improves what changed by 2-opt. What comes out is accepted by the rule of Metropolis; its worth is its prize, less a
// price of its cost. Where edges lead one way, nothing is turned round.
class Annealing {
 public:
  Annealing(const Targets& targets, double limit, std::uint64_t seed);

  // Starts with a route: targets in order, and what the ways to each of them and to the end cost.
  void start(const std::vector<int>& order, const std::vector<double>& links);

  // One step at so far through the schedule, 0 to 1.
  void step(double progress);

  // The best route up to now.
  const std::vector<int>& best();
  double best_prize() const { return best_prize_; }
  int best_visits() const { return static_cast<int>(best_.size()); }

 private:
  static constexpr int kNone = -1;
  struct Place {  // for a target
    int after;
    double added;  // to the cost of the route
    double in = 0;
    double out = 0;
  };

  void ruin(int seed);
  void turn_near(int target);
  void recreate(int seed);
  Place cheapest_place(int target);
  void put_back(int target);
  void improve();
  bool two_opt(int target);
  bool accept(double temperature);
  void remember();
  void enqueue(int target);

  const Targets* targets_;
  double limit_;
  Rng rng_;
  Route route_;
  double unit_;   // the mean prize: temperatures are in it
  double price_;  // of a unit of cost
  std::vector<int> out_;  // taken out, or near what was
  std::vector<int> queue_;
  std::vector<char> marked_;  // [T + 1], in queue_ or out_
  std::int64_t steps_ = 0;
  std::int64_t steps_per_look_;  // at whether the route is the best
  std::vector<int> best_;
  double best_prize_ = -1;
  double best_cost_ = 0;
};

}  // namespace graphdrl
