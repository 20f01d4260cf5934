// A walk as the targets that it makes for.
#pragma once

#include <span>
#include <vector>

#include "graphdrl/planners/targets.h"

namespace graphdrl {

// A route, kept: its targets in order, the costs of the ways to each of them and to the end, what it is worth and
// costs.
struct Tour {
  std::vector<int> order;
  std::vector<double> links;
  double prize = 0;
  double cost = 0;
};

// What a plan's walk makes for, in the order of first visits.
Tour tour_of(const Task& task, const Targets& targets, const Plan& plan);

// The walk that makes for these targets, each by a cheapest way, and for the end.
std::vector<NodeId> walk_of(const Task& task, const Targets& targets, std::span<const int> order);

}  // namespace graphdrl
