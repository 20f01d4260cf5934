// The rules that learn nothing: random moves, depth first and nearest unvisited.
#pragma once

#include <functional>

#include "graphdrl/base/random.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/graph/search.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

// Draws uniformly from the moves that leave enough to get where the walk must end.
class RandomPolicy final : public Policy {
 public:
  // blocked_too: from blocked moves too, on grids from all four directions, as the paper's author's baseline.
  RandomPolicy(std::uint64_t seed, bool blocked_too) : rng_(seed), blocked_too_(blocked_too) {}
  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock = {}) override;

 private:
  Rng rng_;
  bool blocked_too_;
};

// Descends to the first unvisited neighbour in the graph's order, and steps back where there is none; in a directed
// graph it walks to the node entered last from which something is left. Ends with its last first visit, and where the
// next step cannot be paid for with the way to the end. Does not look at prizes. Cost: O(nodes + edges), in directed
// graphs O(nodes in reach) for every way back.
class DepthFirstPlanner final : public Planner {
 public:
  Plan plan(const Task& task, const Clock& clock = {}) override;

 private:
  NearestFirst search_;
};

// Walks the cheapest way to the nearest unvisited node that is worth something, the first one that the search meets,
// until none can be had for what is left with the way to the end. Cost: the sum over first visits of what is nearer
// than they are.
class NearestPlanner final : public Planner {
 public:
  Plan plan(const Task& task, const Clock& clock = {}) override;

 private:
  NearestFirst search_;
};

// What a planner does with its time where there is a deadline, else search(clock) alone: the nearest rule's walk first,
// which costs next to nothing; then search(until), which gives its best plan by an earlier time, walked on by the
// nearest rule. Gives the better of the two.
Plan plan_by_deadline(const Task& task, const Clock& clock, const std::function<Plan(const Clock& until)>& search);

}  // namespace graphdrl
