#include "graphdrl/report/move_scores.h"

#include <array>

#include "graphdrl/env/walk.h"
#include "graphdrl/planners/explorer.h"
#include "graphdrl/planners/paper_policy.h"

namespace graphdrl {
namespace {

void follow(const PlanReport& report, const std::function<void(const Observation&)>& at_node) {
  const End end = report.task.ends_anywhere() ? End::anywhere() : End::at(report.task.end);
  Episode episode(report.world,
                  {.budget = report.task.budget, .end = end, .action_space = action_space_of(report.world)});
  follow_walk(episode, report.plan.walk, at_node);
}

MoveScores shortfalls_along(const PlanReport& report, SharedExplorer explorer) {
  MoveScores scores{.name = "expected shortfall", .lower_is_better = true, .steps = {}};
  ExplorerScorer scorer(std::move(explorer));
  NodeSet visited(report.world.node_count());
  std::vector<float> shortfall;
  follow(report, [&](const Observation& observation) {
    visited.insert(observation.position);
    ExplorerBatch batch;
    const auto visits = scorer.encoder().append(*observation.view,
                                                {.visited = visited,
                                                 .visited_count = observation.visited_count,
                                                 .position = observation.position,
                                                 .spendable = observation.spendable},
                                                kExplorerScope, batch);
    std::vector<MoveScore>& moves = scores.steps.emplace_back();
    if (visits.empty()) return;
    scorer.shortfalls(batch, shortfall);
    for (std::size_t i = 0; i < visits.size(); ++i) moves.push_back({.node = visits[i].node, .score = shortfall[i]});
  });
  return scores;
}

MoveScores q_values_along(const PlanReport& report, PaperPolicy policy) {
  MoveScores scores{.name = "Q-value", .steps = {}};
  follow(report, [&](const Observation& observation) {
    std::array<float, kActionCount> q = {};
    policy.q_values({&observation, 1}, q);
    std::vector<MoveScore>& moves = scores.steps.emplace_back();
    for (int action = 0; action < kActionCount; ++action) {
      if (observation.legal(action)) moves.push_back({.node = observation.target(action), .score = q[action]});
    }
  });
  return scores;
}

}  // namespace

MoveScores scores_along(const PlanReport& report, const std::string& policy) {
  if (policy == "explorer") return shortfalls_along(report, builtin_explorer());
  if (is_explorer_file(policy)) return shortfalls_along(report, read_explorer_file(policy));
  return q_values_along(report, PaperPolicy(read_policy_file(policy)));
}

}  // namespace graphdrl
