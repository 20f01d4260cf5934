// The moves of an annealing. Each changes the route of a draft and can be tried alone; Route::undo() takes it back.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/planners/route.h"
#include "graphdrl/planners/targets.h"

namespace graphdrl {

inline constexpr double kCostRounding = 1e-9;  // relative, of sums of costs and of prizes

// How often moves of a kind are made, and how hot annealing begins: by what is visited most on worlds of the validation
// split in a tenth of EA4OP's time; kSelective by what is collected most on OPLib in 0.5 s an instance
// (docs/search.md). The numbers beside the moves and the annealing were chosen likewise.
struct Style {
  double first_temperature;  // in mean prizes
  double no_string_share;    // of steps that take nothing out, and only turn a part of the route round
  double long_share;         // of steps that take long strings out
  double elsewhere_share;    // of steps that put targets in at a second place too
  double region_share;       // of steps that move up to half of the route elsewhere
};
// Where nearly all can be visited, the order of visits counts.
inline constexpr Style kOrdering = {
    .first_temperature = 1, .no_string_share = 0.5, .long_share = 0.06, .elsewhere_share = 0, .region_share = 0};
// Where much must be left out, the choice of targets counts.
inline constexpr Style kSelective = {
    .first_temperature = 3, .no_string_share = 0.3, .long_share = 0.15, .elsewhere_share = 0.3, .region_share = 0.1};

// What moves work on: a route, what it may cost, and chance. `targets` must outlive it.
struct Draft {
  Draft(const Targets& on, double cost_limit, std::uint64_t seed);

  const Style& style() const { return selective ? kSelective : kOrdering; }
  int random_target() { return static_cast<int>(rng.below(static_cast<std::uint32_t>(targets.end()))); }

  const Targets& targets;
  double limit;
  bool selective = false;
  Rng rng;
  Route route;
  double mean_prize;
  bool equal_prizes;
  std::vector<int> removed;                   // targets to put back; moves that take out append to it
  std::vector<int> region;                    // scratch, as what follows
  std::vector<char> marked;                   // [T + 1], 0 between moves
  std::vector<std::pair<double, int>> keyed;  // targets by their keys of a random order
};

// Takes out targets that stand together.
struct StringRemoval {
  int first;
  int length;  // targets; the route may end before

  // 1 to `longest` targets, one of them `target`. REQUIRES: the route contains it; it is not 0.
  static StringRemoval propose(Draft& draft, int target, std::uint32_t longest);
  void apply(Draft& draft) const;
};

// Turns a part of the route round: a 2-opt move [Croes 1958]. REQUIRES: edges lead both ways.
struct Reversal {
  int first;
  int last;
  double in;     // the cost of the way to `last` then
  double out;    // and on from `first`
  double added;  // to the cost of the route

  // forward: the ways on from two targets of the route swap their ends; else the ways to them. Empty where that changes
  // nothing.
  static std::optional<Reversal> propose(const Draft& draft, int one, int other, bool forward);
  // One at random that the limit allows, of a target and one of its nearest. Of a target that is not in the route, the
  // nearest one in it takes its place.
  static std::optional<Reversal> propose_near(Draft& draft, int target);
  void apply(Draft& draft) const { draft.route.reverse(first, last, in, out); }
};

// Puts a target in.
struct Insertion {
  int target;
  double added;  // to the cost of the route
  int after = Route::kNone;
  double in = 0;   // the cost of the way to it
  double out = 0;  // and on

  // At its cheapest place beside its nearest targets or before the end; some places are passed over at random. If the
  // limit allows none of these, regions move and no near target is in the route: at its cheapest place of all. Empty if
  // the limit allows no place.
  // REQUIRES: the route does not contain the target.
  static std::optional<Insertion> propose(Draft& draft, int target);
  void apply(Draft& draft) const { draft.route.insert(target, after, in, out); }
};

// 2-opt from what changed, until nothing is left to gain there. REQUIRES: edges lead both ways.
class TwoOpt {
 public:
  explicit TwoOpt(const Targets& targets) : queued_(targets.end() + 1) {}

  // Applies a reversal, and looks at its four ends later.
  void apply(const Reversal& reversal, Draft& draft);
  // Improves the route at all that changed since Route::keep().
  void improve(Draft& draft);

 private:
  void enqueue(int target, const Draft& draft);
  bool improve_at(int target, Draft& draft);

  std::vector<int> queue_;  // last in, first out
  std::vector<char> queued_;
};

// Takes out strings of targets, each with one near the seed; in some steps none.
void ruin(Draft& draft, int seed);

// Puts back what was taken out and what is near the seed, in random order; in some steps also what is near another
// target.
void recreate(Draft& draft, int seed);

// Takes a string of up to `longest` targets out, lets what is left of the budget grow a region around the seed, or
// around a target drawn that is not in the route, and puts back what still fits.
void move_region(Draft& draft, int seed, std::uint32_t longest);

// In a random region, of a tenth to a half of all targets, the route visits what `other` visits, as far as the limit
// allows; what it had there is put back where it fits.
void cross_over(Draft& draft, const std::vector<int>& other);

}  // namespace graphdrl
