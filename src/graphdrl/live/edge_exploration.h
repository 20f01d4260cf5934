// Edges of a map that is not known beforehand, explored as a client's moves are.
#pragma once

#include "graphdrl/answer/answer.h"
#include "graphdrl/eval/comparison.h"

namespace graphdrl {

// A task answered, whatever counts: make_plan(), but for edges of a map that is not known.
//
// There a visit shows the node's edges and where they lead. They are the node's moves, by name where they have labels,
// in an order by the request's seed. Policies are those of LiveExploration. The bound is that of the cheapest edges.
// Throws Error on what does not go with edges: seen nodes that count, another reveal, an old map, policies of one's
// own, an end that is not the start.
Answer answer_task(const World& world, const Task& task, const PlanRequest& request, const Clock& clock = {});

// Makes a comparison one of edges, of walks as answer_task() makes them. Throws Error on policies that there are not.
void compare_edges(ComparisonOptions& options, std::optional<double> reset_cost);

}  // namespace graphdrl
