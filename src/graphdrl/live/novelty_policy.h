// Which untried move of a live exploration is likeliest to show something new for what it costs.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "graphdrl/live/state_graph.h"
#include "graphdrl/planners/rules.h"

namespace graphdrl {

// Where states count: the move with the greatest chance of a new state for its cost, the way there among it. The chance
// is a mixture of six estimates: the share of moves that led to a new state so far; that of moves of this name; one by
// which a name finds something once; and each of these three times what moves of this state found. They are weighed by
// how well each has foretold what came [Bayesian mixture]. Moves of a name that leads to where nothing is left to try
// cost more by a share of the way back. A move that is not clearly better than a nearer one waits.
//
// Where transitions count: the nearest untried move; of equally near ones the one that leads least often to where
// nothing is left, then that of the state with most of them.
//
// Only the kMostCandidates nearest moves are looked at. What the numbers are, and what they bring: docs/live.md.
class NoveltyPolicy final : public FirstVisitPolicy {
 public:
  // graph: must outlive it.
  explicit NoveltyPolicy(const StateGraph& graph) : graph_(&graph) {}

  // An untried move of a state led to another state. REQUIRES: the graph does not know that yet.
  void learn(std::int32_t state, std::int32_t move, std::int32_t to, bool is_new);

 private:
  static constexpr int kMostOutcomes = 16;
  static constexpr int kMostCandidates = 512;
  static constexpr int kModels = 6;

  struct Tries {
    double tries = 0;
    double found = 0;  // that led to a new state
  };
  // Of moves of one name.
  struct Named {
    Tries recent;                                       // each counts for less with every later one
    bool has_found = false;                             // at any time
    int targets = 0;                                    // different states that they led to
    int outcomes = 0;                                   // of all times …
    std::array<std::int32_t, kMostOutcomes> last = {};  // … the last ones: states; -1 where the state was the same
  };

  NodeId choose(const Exploration& now, const Observation& observation) override;
  std::array<double, kModels> chances(std::int32_t state, std::int32_t name) const;
  double chance(std::int32_t state, std::int32_t name) const;
  double stranded(const Exploration& now, std::int32_t state, std::int32_t name);
  double cost_to_untried(const Exploration& now, std::int32_t state);

  const StateGraph* graph_;
  Tries all_;
  std::vector<Named> by_name_;
  std::vector<Tries> by_state_;
  std::unordered_set<std::uint64_t> seen_;           // names with states that they led to
  std::array<double, kModels> log_likelihood_ = {};  // of what came, by each estimate
  NearestFirst look_;
  std::vector<double> to_untried_;        // [states], looked up for this choice …
  std::vector<std::uint64_t> looked_up_;  // … in this one
  std::uint64_t choice_ = 0;
};

}  // namespace graphdrl
