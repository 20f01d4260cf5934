// One chain of the local search.
#pragma once

#include <utility>
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

  // Goes on with a child of the route and another one: in a region at random, of a tenth to a half of all targets, it
  // makes for what the other one makes for. The best route up to now is the child.
  // REQUIRES: start() came before, and no step().
  void recombine(const std::vector<int>& other);

  // Whether a route of this prize leaves so much out that it matters more what to visit than in which order. Then steps
  // also move budget between regions, and begin hotter.
  static bool is_selective(const Targets& targets, double prize);

  // One step at so far through the schedule, 0 to 1. REQUIRES: start() came before.
  void step(double progress);

  // The best route up to now: its targets in order. What follows is of it, once it was called.
  const std::vector<int>& best();
  const std::vector<double>& best_links() const { return best_links_; }  // the costs of the ways, as for start()
  double best_prize() const { return best_prize_; }
  double best_cost() const { return best_cost_; }
  int best_visits() const { return static_cast<int>(best_.size()); }

 private:
  static constexpr int kNone = -1;
  struct Place {  // for a target
    int after;
    double added;  // to the cost of the route
    double in = 0;
    double out = 0;
  };

  struct Turn {  // a part of the route, to be turned round
    int first;
    int last;
    double in;     // the cost of the way to `last` then
    double out;    // and on from `first`
    double added;  // to the cost of the route
  };

  struct Style {
    double first_temperature;  // in mean prizes
    double no_string_share;    // of steps that only turn a part of the route round
    double long_share;         // of steps that take out long strings
    double elsewhere_share;    // of steps that put targets in at another place too
    double region_share;       // of steps that move up to half of the route elsewhere
  };
  static const Style kOrdering;
  static const Style kSelective;

  void ruin(int seed);
  void take_string(int first, int length);
  void move_region(int seed);
  void put_back_removed();
  void put_in_random_order(std::vector<int>& targets);
  Turn turn_of(int target, int other, bool forward) const;
  void turn(const Turn& turn);
  void turn_near(int target);
  void recreate(int seed);
  Place cheapest_place(int target);
  void put_back(int target);
  void improve();
  void settle_links();
  bool two_opt(int target);
  bool too_dear() const;
  bool accept(double temperature);
  void remember();
  void enqueue(int target);

  const Targets* targets_;
  double limit_;
  Rng rng_;
  Style style_;
  Route route_;
  double unit_;  // the mean prize: temperatures are in it
  bool equal_prizes_;
  double price_;              // of a unit of cost
  std::vector<int> removed_;  // taken out, or near what was
  std::vector<int> grown_;    // a region, from its seed on
  std::vector<std::pair<double, int>> keyed_;
  std::vector<int> queue_;
  std::vector<int> loose_;  // targets whose way on may cost less than is known
  NearestFirst search_;
  std::vector<char> marked_;  // [T + 1], in queue_ or removed_
  std::int64_t steps_ = 0;
  std::int64_t steps_per_look_;  // at whether the route is the best
  std::vector<int> best_;
  std::vector<double> best_links_;
  double best_prize_ = -1;
  double best_cost_ = 0;
};

}  // namespace graphdrl
