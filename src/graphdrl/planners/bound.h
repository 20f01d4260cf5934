// Upper bounds on what any walk can be worth: how far from the optimum a plan may be at most.
//
// Four relaxations, of which the least counts:
// - Arrivals. Every node visited is arrived at at least once, by an edge of the biconnected block that joins it to the
//   start. Leaving a block through its entry node costs one more arrival there. So in the tree of blocks, what hangs
//   from a node costs its cheapest arrivals, plus one at the node for every block that the walk does not end in. A
//   dead end is a block of two nodes: both ways are paid. What is cheapest for its prize comes first, whatever has to
//   be visited before it, and the last one in part (a fractional knapsack [Dantzig 1957]). Cost: O(n log² n).
// - The same as an exact knapsack over the tree, the least cost for every number of nodes: tighter, and quadratic at
//   worst. Where all prizes are 1, and while it takes kKnapsackSums sums at most.
// - Colours. In a bipartite graph a walk's nodes alternate in colour, so neither colour has more than its half.
// - Order. In a directed graph a strongly connected component that was left is not entered again.
// The bound holds for directed and weighted graphs, and for walks that must end somewhere; what cannot be reached, and
// left for the end, within the budget counts for nothing.
#pragma once

#include "graphdrl/planners/plan.h"

namespace graphdrl {

inline constexpr double kKnapsackSums = 2e8;

// No walk has a higher prize [Plan::prize]. Once the clock passes, only the sum of prizes, colours and order count.
double max_prize(const Task& task, const Clock& clock = {});

}  // namespace graphdrl
