// Beam search over first visits: a move is a walk to an unvisited node next to visited ground, by the cheapest way
// through visited ground. Level k holds the best partial walks of k first visits.
#pragma once

#include "graphdrl/planners/plan.h"

namespace graphdrl {

struct BeamOptions {
  int width = 50;  // partial walks kept per level
};

inline constexpr int kMaxBeamWidth = 1'000'000;

// The best walk found, the position first; it ends with its last first visit. Of walks that visit as many nodes, the
// cheapest. Deterministic. Empty where the deadline passes before it is
// found.
std::vector<NodeId> beam_walk(const SearchStart& start, const BeamOptions& options, Deadline deadline = {});

// With a time limit, searches again and again with twice the width, until the time is up or a walk is known to be
// optimal; the best walk counts. The first search, of the width given, is always finished.
class BeamPolicy final : public PlanPolicy {
 public:
  explicit BeamPolicy(BeamOptions options, TimeLimit limit = {}) : options_(options), limit_(limit) {}

  Plan plan(const SearchStart& start) override;

 private:
  BeamOptions options_;
  TimeLimit limit_;
};

}  // namespace graphdrl
