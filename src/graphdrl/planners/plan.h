// Planners that think out a whole walk before they take its first step.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "graphdrl/planners/baselines.h"

namespace graphdrl {

// Where a search begins.
struct SearchStart {
  const World* world;
  NodeId position;
  std::vector<bool> visited;  // [N], the position among them
  double budget_left;         // in units of cost

  double limit() const { return spending_limit(budget_left); }
};

SearchStart search_start(const World& world, NodeId start, double budget);

struct Plan {
  std::vector<NodeId> walk;  // the position first
  bool optimal = false;      // proved so
};

// How long a planner may think about one plan; empty for as long as it takes.
using TimeLimit = std::optional<std::chrono::duration<double>>;
using Deadline = std::optional<std::chrono::steady_clock::time_point>;

Deadline deadline_after(TimeLimit limit);
inline bool passed(Deadline deadline) {
  return deadline && std::chrono::steady_clock::now() >= *deadline;
}

// Follows the walk that plan() gives and stops at its end; plans anew where someone else led the way.
class PlanPolicy : public SingleEpisodePolicy {
 public:
  virtual Plan plan(const SearchStart& start) = 0;

 private:
  int act_on(const Observation& observation) final;

  struct Remembered {
    double budget;
    std::vector<NodeId> walk;
  };
  std::map<std::pair<const World*, NodeId>, Remembered> plans_;  // the last one from each start
};

// Valid nodes visited after a walk, those before it among them.
int visited_after(const SearchStart& start, std::span<const NodeId> walk);

// The walk that makes these first visits one after the other, each by the cheapest way through visited ground.
// REQUIRES: there is such a way.
std::vector<NodeId> walk_through(const SearchStart& start, std::span<const NodeId> first_visits);

// What the steps of a walk cost; a repeated node is a blocked move and costs 1. REQUIRES: every other step follows an
// edge.
double walk_cost(const World& world, std::span<const NodeId> walk);

}  // namespace graphdrl
