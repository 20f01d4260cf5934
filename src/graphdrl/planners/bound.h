// Upper bounds on what any walk can visit: how far from the optimum a plan may be at most.
//
// Three relaxations, of which the least counts:
// - Arrivals. Every node visited is arrived at once at least, by an edge of the biconnected block that joins it to the
//   start; whoever leaves a block through the node he came in by arrives there once more. So in the tree of blocks and
//   cut nodes, visiting k nodes of a branch costs at least the sum of their cheapest arrivals, plus one at the branch's
//   root for every block that the walk does not end in. The least cost for every k comes from a knapsack over that
//   tree. A dead end is a block of two nodes: both ways are paid.
// - Colours. In a bipartite graph a walk's nodes alternate in colour, so neither colour has more than its half.
// - Order. In a directed graph a strongly connected part that was left is not entered again.
// The bound holds for directed and weighted graphs; a part that cannot be reached counts for nothing.
#pragma once

#include "graphdrl/planners/plan.h"

namespace graphdrl {

// No walk from here within the budget left leaves more nodes visited than this, those visited before it among them.
// Cost: O(edges + nodes in reach · nodes the
// budget allows).
int max_visited(const SearchStart& start);

}  // namespace graphdrl
