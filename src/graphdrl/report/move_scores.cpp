#include "graphdrl/report/move_scores.h"

#include <array>

#include "graphdrl/env/episode.h"
#include "graphdrl/planners/paper_policy.h"
#include "graphdrl/planners/registry.h"

namespace graphdrl {
namespace {

void follow(const Answer& answer, const std::function<void(const Observation&)>& at_node) {
  Episode episode(answer.world, answer.task, {.action_space = action_space_of(answer.world)});
  follow_walk(episode, answer.plan.walk, at_node);
}

MoveScores shortfalls_along(const Answer& answer, SharedExplorer explorer) {
  MoveScores scores{.name = "expected shortfall", .lower_is_better = true, .steps = {}};
  ExplorerScorer scorer(std::move(explorer));
  NodeSet ground(answer.world.node_count());
  ExplorerScratch scratch;
  std::vector<float> shortfall;
  follow(answer, [&](const Observation& observation) {
    ground.insert(observation.position);
    ExplorerBatch batch;
    const auto visits = encode(Exploration(observation, ground), scratch, batch).visits;
    std::vector<MoveScore>& moves = scores.steps.emplace_back();
    if (visits.empty()) return;
    scorer.shortfalls(batch, shortfall);
    for (std::size_t i = 0; i < visits.size(); ++i) moves.push_back({.node = visits[i].node, .score = shortfall[i]});
  });
  return scores;
}

MoveScores q_values_along(const Answer& answer, PaperPolicy policy) {
  MoveScores scores{.name = "Q-value", .steps = {}};
  follow(answer, [&](const Observation& observation) {
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

MoveScores scores_along(const Answer& answer, const std::string& policy) {
  KnownMapPolicy trained = read_known_map_policy(policy);
  if (auto* const explorer = std::get_if<SharedExplorer>(&trained)) return shortfalls_along(answer, *explorer);
  return q_values_along(answer, PaperPolicy(std::get<PaperParameters>(std::move(trained))));
}

}  // namespace graphdrl
