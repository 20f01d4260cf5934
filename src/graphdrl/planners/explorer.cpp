#include "graphdrl/planners/explorer.h"

#include <algorithm>
#include <cmath>

#include "graphdrl/base/error.h"
#include "graphdrl/planners/baselines.h"

namespace graphdrl {
namespace {

// Of the rule of choose(), both in nodes; chosen on the validation split (docs/explorer.md).
constexpr double kWorthOfBudget = 0.5;  // of a mean edge's cost, to spend on work out of scope
constexpr double kIndifference = 0.8;   // by which the nearest may fall behind, all work being out of scope

constexpr int kChoicesPerTick = 8;

}  // namespace

SharedExplorer builtin_explorer() {
  static const SharedExplorer explorer = std::make_shared<const ExplorerParameters>(
      read_explorer(Safetensors::parse(std::string(builtin_explorer_file()), "the policy in the program")));
  return explorer;
}

void ExplorerScorer::shortfalls(const ExplorerBatch& batch, std::vector<float>& shortfall) {
  shortfall.resize(static_cast<std::size_t>(batch.visit_count()));
  network_.forward(batch, shortfall);
  for (const float value : shortfall) {
    if (!std::isfinite(value)) throw Error({.what = "the explorer's weights are too large to compute with"});
  }
}

bool ExplorerScorer::score(std::span<const Exploration> states, std::vector<ScoredVisit>& visits) {
  visits.clear();
  batch_.clear();
  bool left_out = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const SeenVisits seen = encode(states[i], scratch_, batch_);
    for (const FirstVisit& visit : seen.visits) {
      visits.push_back({.state = static_cast<int>(i), .visit = visit, .score = 0});
    }
    left_out = left_out || seen.left_out;
  }
  if (visits.empty()) return left_out;
  shortfalls(batch_, shortfall_);
  const double unit = states[0].view().open().mean_cost();
  for (std::size_t i = 0; i < visits.size(); ++i) {
    // Cost up to now counts as cost to come does.
    const int state = visits[i].state;
    visits[i].score = double{shortfall_[i]} - batch_.ceiling[state] - kWorthOfCost * states[state].spendable() / unit;
  }
  return left_out;
}

std::size_t ExplorerScorer::choose(const Task& task, const ExplorerBatch& batch, std::span<const FirstVisit> visits) {
  const View& view = task.view();
  shortfalls(batch, shortfall_);
  const double unseen = batch.unseen[0];
  const double unit = view.open().mean_cost();
  const double mean_prize = view.total_prize() / view.valid_count();
  for (std::size_t i = 0; i < visits.size(); ++i) {
    shortfall_[i] += static_cast<float>(kWorthOfBudget * unseen * visits[i].cost / unit);
    if (task.has_prizes() && mean_prize > 0) {
      shortfall_[i] -= static_cast<float>(task.prize(visits[i].node) / mean_prize);
    }
  }
  // Where edges lead one way, the nearest may be a trap.
  const double indifference = view.open().directed() ? 0 : kIndifference * unseen * unseen;
  const double most = *std::min_element(shortfall_.begin(), shortfall_.end()) + indifference;
  const auto choice = std::find_if(shortfall_.begin(), shortfall_.end(), [&](float score) { return score <= most; });
  return static_cast<std::size_t>(choice - shortfall_.begin());
}

Plan ExplorerPlanner::plan(const Task& task, const Clock& clock) {
  return plan_by_deadline(task, clock, [&](const Clock& until) { return walk_until(task, until); });
}

Plan ExplorerPlanner::walk_until(const Task& task, const Clock& clock) {
  Ticker ticker(clock, kChoicesPerTick);
  NodeSet ground = task.ground();
  Exploration state(task, ground);
  ExplorerBatch batch;
  std::vector<NodeId> first_visits;
  bool optimal = task.view().open().straight_ways_suffice();
  do {
    batch.clear();
    const auto [visits, left_out] = encode(state, scratch_, batch);
    // Where all first visits are too far off to be looked at, the nearest.
    const FirstVisit choice = !visits.empty() ? visits[scorer_->choose(task, batch, visits)]
                              : left_out      ? state.nearest_first_visit(search_)
                                              : FirstVisit();
    if (choice.node == kNoNode) return plan_of_walk(task, walk_through(task, first_visits, search_), optimal);
    optimal = optimal && visits.size() == 1 && !left_out;
    first_visits.push_back(choice.node);
    state.make(choice, ground);
  } while (!ticker.tick(state.ground_count()));
  return plan_of_walk(task, walk_through(task, first_visits, search_));
}

}  // namespace graphdrl
