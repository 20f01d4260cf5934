// Policies that choose the next node to visit by what is known around: nearest, depth first, and their kin.
#pragma once

#include <vector>

#include "graphdrl/env/exploration.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// Goes to one first visit after the other, each by the cheapest way through ground; then to where the walk must end.
// Chooses anew once more is known; some rules hold a choice for a while. On an unknown map first visits lead to what
// was seen and not visited, or on known ways to the frontier where what is seen counts.
class FirstVisitPolicy : public Policy {
 public:
  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock = {}) final;

 protected:
  // held_for: first visits for which a choice is held although more becomes known.
  explicit FirstVisitPolicy(std::uint64_t held_for = 0) : held_for_(held_for) {}

  // The first visit to make; kNoNode for none. The way there must be the one that search() met last.
  virtual NodeId choose(const Exploration& now, const Observation& observation) = 0;
  NearestFirst& search() { return search_; }

 private:
  // Under way to what was chosen.
  struct Trip {
    View view;                               // of the walk: walks of unknown maps may have the same numbers
    std::uint64_t version;                   // of what was known then
    std::vector<NodeId> way = {};            // up to the goal
    std::vector<std::uint64_t> hashes = {};  // [way + 1], of the walk before each step, and at the goal
    std::size_t next = 0;                    // the step after the one that was asked for last
  };

  Trip* trip_of(const Observation& now);
  int act_on(const Observation& now);
  bool holds(const Trip& trip, const Observation& now) const;

  std::uint64_t held_for_;
  NearestFirst search_;
  std::vector<Trip> trips_;  // the last ones, kMostTrips at most
  std::size_t oldest_ = 0;
};

enum class Rule {
  kNearest,     // the nearest first visit
  kDepthFirst,  // the one seen last; of those seen at once the nearest
  kPocket,      // nearest; of equally near ones the one with most neighbours visited, then the one seen last
  kOpen,        // nearest; of equally near ones the one with fewest, then the one seen last
  kFrontier,    // three times the distance less the size of the frontier around it, least first [explore_lite]
  kTour,        // the first stop of a short tour of the frontier's parts; held for a while
};

// On a known map nothing was seen last. Ties go to the first one that the search meets; where the order of neighbours
// means nothing [View::ordered()], to any of them, by the walk's hash.
//
// A choice costs what is nearer than its choice; of kFrontier and kTour all ground in reach.
class RulePolicy final : public FirstVisitPolicy {
 public:
  // smallest_part: of kTour, see first_stop_of_frontier_tour().
  explicit RulePolicy(Rule rule, int smallest_part = 1);

 private:
  NodeId choose(const Exploration& now, const Observation& observation) override;
  NodeId choose_nearest(const Exploration& now, std::uint64_t walk_hash);
  NodeId choose_last_seen(const Exploration& now, std::uint64_t walk_hash);
  NodeId choose_by_frontier(const Exploration& now);

  Rule rule_;
  int smallest_part_;
};

}  // namespace graphdrl
