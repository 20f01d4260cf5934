// What it takes to visit everything.
#pragma once

#include <functional>
#include <optional>

#include "graphdrl/env/world.h"

namespace graphdrl {

// No walk that begins at `start` and costs less than this visits every node: the bound [planners/bound.h] turned round.
// Where costs are no whole numbers, rounded down to nine digits. Empty where no walk from there does at all. Of a
// complete graph: the cheapest edge into every other node that is worth something, and the way to the farthest one.
// Cost: a bound for each of up to 60 budgets; O(N²) on a complete graph, where progress is told how much is done, 0
// to 1. REQUIRES: start is a valid node.
std::optional<double> least_budget(const World& world, NodeId start,
                                   const std::function<void(double share)>& progress = {});

// The same by asking the bound, whatever the graph. For tests.
std::optional<double> least_budget_by_bounds(const World& world, NodeId start);

}  // namespace graphdrl
