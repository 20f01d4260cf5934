// Improves long walks part by part.
#pragma once

#include <cstdint>

#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Each part of a walk, some hundred steps, is a small task of its own: from where it begins to where it ends, worth
// something where no other part comes first, and in what lies close by and is not visited [POPMUSIC: Taillard and Voss
// 2002]. Parts are annealed side by side, at a price of a unit of cost. Then the budget goes to those to which it
// brings most, and what is left to walking on. So a part costs the same in a world of any size.
//
// Never worse than best, whose bound says when to stop. steps: of annealing, in all; 0: until the clock passes. Ends
// once several sweeps in a row bring nothing. The walk depends on the task, the steps and the seed alone if the clock
// does not pass, and is the better the later it does. Memory: O(N).
// REQUIRES: the graph is not complete.
Plan improve_by_parts(const Task& task, Plan best, std::int64_t steps, std::uint64_t seed, const Clock& clock = {});

}  // namespace graphdrl
