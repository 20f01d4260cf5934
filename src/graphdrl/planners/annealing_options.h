// The numbers of the local search's annealing.
#pragma once

namespace graphdrl {

// Defaults are those by which the search visits most on worlds of the validation split in a tenth of EA4OP's time;
// those of `selective`, by which it collects most on OPLib in 0.5 s an instance (docs/search.md).
struct AnnealingOptions {
  struct Style {
    double first_temperature;  // in mean prizes
    double no_string_share;    // of steps that take nothing out, and only turn a part of the route round
    double long_share;         // of steps that take long strings out
    double elsewhere_share;    // of steps that put targets in at a second place too
    double region_share;       // of steps that move up to half of the route elsewhere
  };

  // Where nearly all can be visited, the order of visits counts.
  Style ordering = {
      .first_temperature = 1, .no_string_share = 0.5, .long_share = 0.06, .elsewhere_share = 0, .region_share = 0};
  // Where much must be left out, the choice of targets counts.
  Style selective = {
      .first_temperature = 3, .no_string_share = 0.3, .long_share = 0.15, .elsewhere_share = 0.3, .region_share = 0.1};
  double selective_share = 0.3;    // of the prize: a start that leaves out more is selective
  double last_temperature = 0.08;  // in mean prizes
  double price = 0.6;              // worth of the whole budget, in prizes of the best route: cheaper routes are better

  int most_strings = 2;      // taken out in a step
  int short_string = 5;      // targets at most, in most steps
  int long_string = 40;      // targets at most, in the others: a branch of a maze or of a tree
  double blink = 0.03;       // share of places passed over, so that the same targets go to different places
  int two_opt_near = 10;     // nearest targets that 2-opt tries
  int turn_near = 5;         // nearest targets that a random turn draws from
  int turn_tries = 4;        // draws until one can be paid for
  int grow_near = 10;        // nearest targets by which a region grows from each of its own
  int grow_failures = 5;     // targets that do not fit, until a region grows no more
  int seed_tries = 20;       // draws of a target that is in the route, or is not
  int longest_moved = 2000;  // targets of a region that moves: half of a route in worlds of up to 60x60

  double least_region = 0.1;  // of all targets, taken from the other route of two
  double most_region = 0.5;
  int largest_region = 1000;  // targets, likewise: more take longer than a look at the clock may wait

  int looks = 256;  // the best route is copied at most every T / looks steps of T targets: a copy costs T
};

}  // namespace graphdrl
