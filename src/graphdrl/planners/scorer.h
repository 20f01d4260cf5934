// The boundary between searches and what scores their states: the explorer's network on the CPU, later others
// elsewhere.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/env/exploration.h"

namespace graphdrl {

// A first visit of one of the states scored together.
struct ScoredVisit {
  int state;  // its place among them
  FirstVisit visit;
  double score;  // of what will be left unvisited in the end, in nodes; lower is better, and comparable across states
};

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

}  // namespace graphdrl
