#include "graphdrl/eval/rollout.h"

#include <algorithm>
#include <stdexcept>

namespace graphdrl {
namespace {

constexpr int kMostInBlock = 64;
constexpr std::int64_t kMostNodesInBlock = 1 << 22;  // 16 MB of visit counts

void step(Episode& episode, int action) {
  const Observation now = episode.observation();
  if (action < 0 || action >= now.action_count() || !now.affordable(action)) {
    throw std::logic_error("a policy takes a step that cannot be taken");
  }
  episode.step(action);
}

}  // namespace

int block_size(const World& world) {
  return static_cast<int>(std::clamp<std::int64_t>(kMostNodesInBlock / world.node_count(), 1, kMostInBlock));
}

std::vector<RolloutResult> roll_out(const Episode& episode, std::span<const NodeId> starts, Policy& policy,
                                    const Clock& clock) {
  std::vector<Episode> episodes(starts.size(), episode);
  std::vector<int> running;
  for (int i = 0; i < std::ssize(starts); ++i) {
    episodes[i].reset(starts[i]);
    if (!episodes[i].done()) running.push_back(i);
  }
  std::vector<Observation> observations;
  std::vector<int> actions;
  while (!running.empty() && !clock.passed()) {
    observations.clear();
    for (const int i : running) observations.push_back(episodes[i].observation());
    actions.resize(running.size());
    policy.act(observations, actions, clock);
    std::vector<int> going_on;
    for (std::size_t k = 0; k < running.size(); ++k) {
      if (actions[k] == kStop) continue;
      Episode& running_one = episodes[running[k]];
      step(running_one, actions[k]);
      if (!running_one.done()) going_on.push_back(running[k]);
    }
    running = std::move(going_on);
  }
  std::vector<RolloutResult> results;
  results.reserve(episodes.size());
  for (const Episode& ended : episodes) results.push_back({ended.walk(), ended.prize()});
  return results;
}

Plan plan_by_steps(const World& world, const Task& task, Policy& policy, const Clock& clock) {
  Ticker ticker(clock, /*every=*/1);  // a step may take as long as the policy likes
  Episode episode(world, task, {.action_space = action_space_of(world)});
  std::size_t last_visit = 1;  // length of the walk up to it
  while (!episode.done() && !ticker.tick(episode.visited_count())) {
    const Observation now = episode.observation();
    const int visited = episode.visited_count();
    int action = kStop;
    policy.act({&now, 1}, {&action, 1}, clock);
    if (action == kStop) break;
    step(episode, action);
    if (episode.visited_count() > visited) last_visit = episode.walk().size();
  }
  std::vector<NodeId> walk = episode.walk();
  if (task.ends_anywhere()) walk.resize(last_visit);
  NearestFirst search;
  append_way_to_end(task, walk, search);
  return plan_of_walk(task, std::move(walk));
}

}  // namespace graphdrl
