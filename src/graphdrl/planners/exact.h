// Exact search: the walk that visits the most nodes a budget allows.
//
// A walk that wastes nothing goes from one first visit to the next by the shortest way through visited ground, so a
// state is (visited set, position) and a move is a first visit. States are expanded in order of waste, the steps that
// visited nothing new: a state that wasted w of a budget b can never gain more than b - w nodes, so the search ends as
// soon as what it has found cannot be beaten. Among the optimal walks it returns the cheapest, and of these the
// lexicographically first.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"

namespace graphdrl {

inline constexpr int kExactMaxNodes = 64;                  // valid nodes in reach of the start: a set is one word
inline constexpr std::size_t kExactMaxStates = 2'000'000;  // then a search gives up

class SearchOutOfReach : public Error {
 public:
  using Error::Error;
};

// Where a search begins. `visited`: a value per node, the start's among them.
struct SearchStart {
  const World* world;
  NodeId position;
  std::vector<bool> visited;
  double budget_left;  // steps
};

SearchStart search_start(const World& world, NodeId start, double budget);

// How many nodes an optimal walk visits on top of those already visited. Empty where the search is out of reach: too
// many nodes or too many states, never too much time, so that the answer is the same everywhere.
std::optional<int> exact_gain(const SearchStart& start);

// The optimal walk, `position` first. Empty where out of reach.
std::optional<std::vector<NodeId>> exact_walk(const SearchStart& start);

// Follows the exact walk and stops at its end. Throws SearchOutOfReach.
class ExactPolicy final : public SingleEpisodePolicy {
 private:
  int act_on(const Observation& observation) override;

  // Whole walks, by world, start and budget.
  std::map<std::tuple<const World*, NodeId, double>, std::vector<NodeId>> walks_;
};

}  // namespace graphdrl
