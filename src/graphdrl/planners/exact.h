// Exact search: the walk that visits the most nodes a budget allows.
//
// An optimal walk goes from one first visit to the next by the cheapest way through visited ground. So a state is
// (visited set, position), and a move is a first visit.
//
// If every edge costs 1, states are expanded in order of waste, the steps that visited nothing new. A state that wasted
// w of a budget b never gains more than b - w nodes, so the search ends once its best walk cannot be beaten. Among the
// optimal walks it returns the cheapest, and of these the lexicographically first.
//
// If edges have costs, nodes prizes, or the walk must end somewhere, states are expanded in order of an upper bound of
// their worth, every node left at the cost of its cheapest arrival. Among the optimal walks it returns the cheapest; of
// several such, always the same one.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl {

inline constexpr int kExactMaxNodes = 64;                  // valid nodes that the budget reaches: a set is one word
inline constexpr std::size_t kExactMaxStates = 2'000'000;  // then a search gives up
inline constexpr double kExactMaxWork = 5e7;               // of branch and cut: some seconds [LpBound::Effort]

// Nodes within a task's limit; of more than kExactMaxNodes one more than these.
std::size_t nodes_in_reach(const Task& task);

class SearchOutOfReach : public Error {
 public:
  using Error::Error;
};

// The prize of an optimal walk [Plan::prize]. Empty if the search is out of reach: too many nodes or states, never too
// much time, so that the answer is the same everywhere.
std::optional<double> exact_prize(const Task& task);

// The optimal walk. Empty if out of reach, or once the clock passes.
std::optional<std::vector<NodeId>> exact_walk(const Task& task, const Clock& clock = {});

// Searches as above. If that is out of reach, goes on by branch and cut [LpBound] from another planner's walk; the
// result need not be the cheapest of its prize. Throws SearchOutOfReach if neither ends within its limits. With a
// deadline the three share the time, and the best walk is given once it passes.
class ExactPlanner final : public Planner {
 public:
  explicit ExactPlanner(std::unique_ptr<Planner> incumbent = std::make_unique<NearestPlanner>())
      : incumbent_(std::move(incumbent)) {}

  Plan plan(const Task& task, const Clock& clock = {}) override;

 private:
  std::unique_ptr<Planner> incumbent_;
};

}  // namespace graphdrl
