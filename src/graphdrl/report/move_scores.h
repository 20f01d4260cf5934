// How a policy scores its possible moves.
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

// The scores along a plan's walk. policy: explorer, or the file of an explorer or of a network of the paper. An
// explorer scores first visits by their shortfall [planners/explorer.h]; a network of the paper scores the neighbouring
// cells by their Q-values. Throws Error if the policy cannot be read or does not work in this world.
MoveScores scores_along(const Answer& answer, const std::string& policy);

}  // namespace graphdrl
