// Beam search over first visits: a move is a walk to an unvisited node next to visited ground, by the cheapest way
// through visited ground. Level k holds the best partial walks of k first visits.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "graphdrl/planners/plan.h"

namespace graphdrl {

// A first visit of one of the states scored together.
struct ScoredVisit {
  int state;  // its place among them
  FirstVisit visit;
  double score;  // of what will be left unvisited in the end, in nodes; lower is better, and comparable across states
};

// What scores the states of a beam: the explorer's network on the CPU, later others elsewhere.
class FirstVisitScorer {
 public:
  virtual ~FirstVisitScorer() = default;

  // Scores the first visits of each state, of all or of the nearest; those of a state stand together, nearest first.
  // `visits` is overwritten. Gives whether first visits of any state were left out.
  // REQUIRES: at least one state; all are of one task.
  virtual bool score(std::span<const Exploration> states, std::vector<ScoredVisit>& visits) = 0;

  // How many states to score together at most, so that a deadline is not missed by much.
  virtual int most_states() const = 0;
  // How many first visits of a state are scored at most, those equally near aside.
  virtual int most_visits() const = 0;
};

struct BeamOptions {
  int width = 50;  // partial walks kept per level
  // First visits tried from each, nearest first, and as many equally near ones as make it kTiesPerBranch · branching. A
  // scorer tries all in its scope.
  int branching = 16;
};

inline constexpr int kTiesPerBranch = 4;
inline constexpr int kMaxBeamWidth = 1'000'000;
inline constexpr double kMaxBeamBytes = 4e9;

// Whether a beam without a scorer needs kMaxBeamBytes at most.
bool beam_fits(const View& view, const BeamOptions& options);

// The best walk found; it ends with its last first visit, or goes on to where it must end. Of walks that visit as many
// nodes, the cheapest. Each level keeps a third by each of three rankings, since none works everywhere: the cost spent,
// plus all, a quarter or none of the penalties for leftovers. With a scorer, its score replaces the last one; it scores
// the first visits of ⌈¾ √width⌉ partial walks of a level: two thirds of them the best by its score, a third the best
// by all penalties. First visits that it did not score rank behind by score, the cheapest first. A width of one keeps
// by the first ranking only.
//
// Optimal if no partial walk was dropped and no first visit left out. Deterministic. Once the clock passes, the best
// partial walk. Cost: a level searches around its partial walks, as far as first visits may still be kept.
//
// With prizes, rankings subtract their worth from the cost spent, at the price of all prizes for the whole budget.
// Throws Error if the beam could need more than kMaxBeamBytes.
// REQUIRES: width and branching of at least 1.
Plan beam_plan(const Task& task, const BeamOptions& options, const Clock& clock = {},
               FirstVisitScorer* scorer = nullptr);

// Searches once without a scorer and, if it has one, once with it, and takes the better walk. With a deadline it goes
// on with twice the width and branching each time, until the clock passes, a walk is proved optimal or memory would run
// short; a search cut short is finished by the nearest rule [plan_by_deadline()].
class BeamPlanner final : public Planner {
 public:
  // other: with a deadline, its plan is tried too; may be null.
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
