#include "graphdrl/eval/rollout.h"

namespace graphdrl {

std::vector<RolloutResult> roll_out(const World& world, std::span<const NodeId> starts, const EpisodeOptions& options,
                                    Policy& policy) {
  std::vector<Episode> episodes(starts.size(), Episode(world, options));
  std::vector<std::size_t> running;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    episodes[i].reset(starts[i]);
    if (!episodes[i].done()) running.push_back(i);
  }
  std::vector<Observation> observations;
  std::vector<int> actions;
  while (!running.empty()) {
    observations.clear();
    for (const std::size_t i : running) observations.push_back(episodes[i].observation());
    actions.resize(running.size());
    policy.act(observations, actions);
    std::vector<std::size_t> going_on;
    for (std::size_t k = 0; k < running.size(); ++k) {
      if (actions[k] == kStop) continue;
      Episode& episode = episodes[running[k]];
      episode.step(actions[k]);
      if (!episode.done()) going_on.push_back(running[k]);
    }
    running = std::move(going_on);
  }
  std::vector<RolloutResult> results;
  for (const Episode& episode : episodes) results.push_back({episode.walk(), episode.coverage()});
  return results;
}

}  // namespace graphdrl
