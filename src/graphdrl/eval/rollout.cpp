#include "graphdrl/eval/rollout.h"

#include "graphdrl/env/vector_env.h"

namespace graphdrl {

std::vector<RolloutResult> roll_out(const World& world, std::span<const NodeId> starts, const EpisodeOptions& options,
                                    Policy& policy) {
  VectorEnv env(world, options, static_cast<int>(starts.size()));
  std::vector<int> running;
  for (int i = 0; i < env.size(); ++i) {
    env[i].reset(starts[i]);
    if (!env[i].done()) running.push_back(i);
  }
  std::vector<Observation> observations;
  std::vector<int> actions;
  while (!running.empty()) {
    observations.clear();
    for (const int i : running) observations.push_back(env[i].observation());
    actions.resize(running.size());
    policy.act(observations, actions);
    std::vector<int> going_on;
    for (std::size_t k = 0; k < running.size(); ++k) {
      if (actions[k] == kStop) continue;
      Episode& episode = env[running[k]];
      episode.step(actions[k]);
      if (!episode.done()) going_on.push_back(running[k]);
    }
    running = std::move(going_on);
  }
  std::vector<RolloutResult> results;
  for (int i = 0; i < env.size(); ++i) results.push_back({env[i].walk(), env[i].coverage()});
  return results;
}

}  // namespace graphdrl
