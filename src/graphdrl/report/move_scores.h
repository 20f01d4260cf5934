// What a policy thinks of the moves it could make.
#pragma once

#include <string>
#include <vector>

#include "graphdrl/report/plan_files.h"

namespace graphdrl {

struct MoveScore {
  NodeId node;  // where the move leads
  float score;
};

// The scores of the possible moves at every node of a walk.
struct MoveScores {
  std::string name;              // "Q-value"
  bool lower_is_better = false;  // the best move has the lowest score
  std::vector<std::vector<MoveScore>> steps;
};

// What a policy thinks along a plan's walk. policy: explorer, the file of one, or of a network of the paper. An
// explorer scores first visits by their shortfall [planners/explorer.h], a network of the paper the neighbouring cells
// by their Q-values. Throws Error where the policy cannot be read or has no place in this world.
MoveScores scores_along(const PlanReport& report, const std::string& policy);

}  // namespace graphdrl
