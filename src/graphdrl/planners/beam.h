// Beam search over first visits: a move is a walk to an unvisited node next to visited ground, by the cheapest way
// through visited ground. Level k holds the best partial walks of k first visits.
#pragma once

#include <memory>

#include "graphdrl/planners/plan.h"
#include "graphdrl/planners/scorer.h"

namespace graphdrl {

struct BeamOptions {
  int width = 50;      // partial walks kept per level
  int branching = 16;  // first visits looked at from each, nearest first; all in its scope where the scorer scores them
  // true: stop at `branching`, ties broken by the graph's order. false: also take ties, up to kTiesPerBranch ·
  // branching.
  bool cut_ties = false;
};

inline constexpr int kTiesPerBranch = 4;
inline constexpr int kMaxBeamWidth = 1'000'000;
inline constexpr double kMaxBeamBytes = 4e9;

// Whether a beam without a scorer needs kMaxBeamBytes at most.
bool beam_fits(const View& view, const BeamOptions& options);

// The best walk found; it ends with its last first visit, or goes on to where it must end. Of walks that visit as many
// nodes, the cheapest. Each level keeps a third by each of three rankings, since none works everywhere: what was spent
// and all, a quarter or none of the penalties for what is left over. A scorer's word takes the place of the last one;
// it scores the first visits of ⌈¾ √width⌉ partial walks of a level: two thirds of those its own best, a third the best
// by all penalties. First visits that it did not score come behind in its ranking, the cheapest first. A width of one
// keeps by the first ranking only.
//
// Optimal where no partial walk had to be dropped and no first visit was left out. Deterministic. Once the deadline
// passes, the best partial walk. Cost: a level looks at what is near its partial walks and may still be kept.
//
// Where there are prizes, rankings count them against what was spent, at the price of all prizes for the whole budget.
// Throws Error where the beam could need more than kMaxBeamBytes.
// REQUIRES: width and branching of at least 1.
Plan beam_plan(const Task& task, const BeamOptions& options, const Clock& clock = {},
               FirstVisitScorer* scorer = nullptr);

// Searches once without a scorer and, if there is one, once with it; the better walk counts. With a deadline it
// searches again and again with twice the width and branching, until the time is up, a walk is known to be optimal or
// memory would run short; what is cut short is walked on by the nearest rule [plan_by_deadline()].
class BeamPlanner final : public Planner {
 public:
  // other: a planner whose plan is tried too where there is a deadline; may be null.
  explicit BeamPlanner(BeamOptions options, std::shared_ptr<FirstVisitScorer> scorer = nullptr,
                       std::unique_ptr<Planner> other = nullptr)
      : options_(options), scorer_(std::move(scorer)), other_(std::move(other)) {}

  Plan plan(const Task& task, const Clock& clock = {}) override;

 private:
  Plan search_once(const Task& task, const BeamOptions& options, const Clock& clock);
  Plan search_until(const Task& task, const Clock& clock);

  BeamOptions options_;
  std::shared_ptr<FirstVisitScorer> scorer_;
  std::unique_ptr<Planner> other_;
};

}  // namespace graphdrl
