// Beam search over first visits: a move is a walk to an unvisited node next to visited ground, by the cheapest way
// through visited ground. Level k holds the best partial walks of k first visits.
#pragma once

#include "graphdrl/planners/explorer_policy.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

struct BeamOptions {
  int width = 50;      // partial walks kept per level
  int branching = 16;  // first visits looked at from each, nearest first; all in the scope where the guide scores them
  bool cut_ties = false;  // stop there even among equally near ones, of which the graph's order is the judge
};

inline constexpr int kMaxBeamWidth = 1'000'000;
inline constexpr double kMaxBeamBytes = 4e9;

// The best walk found; it ends with its last first visit. Of walks that visit as many nodes, the cheapest. A level is
// kept by three measures in equal parts: what was spent and all, a quarter or none of the penalties for what is left
// over. A guide's word on how many nodes will be visited in the end replaces the last of them; it scores the first
// visits of ⌈¾ √width⌉ partial walks of a level, a third of those the best by all penalties and the others its own
// best. First visits that it did not score come behind in its measure, the cheapest first. A width of one keeps by the
// first measure only. Optimal where no partial walk had to be dropped and no first visit was left out.
// Deterministic. Empty where the deadline passes first. Throws Error where the beam would need more than kMaxBeamBytes.
// REQUIRES: width and branching of at least 1.
std::optional<Plan> beam_plan(const SearchStart& start, const BeamOptions& options, Deadline deadline = {},
                              ExplorerGuide* guide = nullptr);

// With a time limit, searches again and again with twice the width and branching, until the time is up, a walk is known
// to be optimal or memory would run short; the best walk counts. The first search without a guide, of the width given,
// is always finished; with a guide, the explorer's own walk is tried next.
class BeamPolicy final : public PlanPolicy {
 public:
  explicit BeamPolicy(BeamOptions options, TimeLimit limit = {}) : options_(options), limit_(limit) {}

  // Guided: at every width a beam without the guide is searched first; the better walk counts.
  BeamPolicy(BeamOptions options, SharedExplorer guide, TimeLimit limit = {})
      : options_(options), limit_(limit), guide_(std::in_place, std::move(guide)) {}

  Plan plan(const SearchStart& start) override;

 private:
  // Searches once without and, if there is one, once with the guide; `best` becomes the better walk. False where the
  // time is up.
  bool improve(const SearchStart& start, const BeamOptions& options, Deadline deadline, std::optional<Plan>& best);

  BeamOptions options_;
  TimeLimit limit_;
  std::optional<ExplorerGuide> guide_;
};

}  // namespace graphdrl
