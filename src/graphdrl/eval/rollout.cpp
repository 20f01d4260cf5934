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

std::vector<RolloutResult> roll_out(const World& world, std::span<const NodeId> starts, const EpisodeOptions& options,
                                    Policy& policy) {
  std::vector<Episode> episodes(starts.size(), Episode(world, options));
  std::vector<int> running;
  for (int i = 0; i < std::ssize(starts); ++i) {
    episodes[i].reset(starts[i]);
    if (!episodes[i].done()) running.push_back(i);
  }
  std::vector<Observation> observations;
  std::vector<int> actions;
  while (!running.empty()) {
    observations.clear();
    for (const int i : running) observations.push_back(episodes[i].observation());
    actions.resize(running.size());
    policy.act(observations, actions);
    std::vector<int> going_on;
    for (std::size_t k = 0; k < running.size(); ++k) {
      if (actions[k] == kStop) continue;
      Episode& episode = episodes[running[k]];
      step(episode, actions[k]);
      if (!episode.done()) going_on.push_back(running[k]);
    }
    running = std::move(going_on);
  }
  std::vector<RolloutResult> results;
  results.reserve(episodes.size());
  for (const Episode& episode : episodes) results.push_back({episode.walk(), episode.coverage(), episode.prize()});
  return results;
}

Plan plan_by_steps(const World& world, const Task& task, Policy& policy, Deadline deadline, const Report& report) {
  Ticker ticker(deadline, report, /*every=*/1);  // a step may take as long as the policy likes
  const End end = task.ends_anywhere() ? End::anywhere() : End::at(task.end);
  Episode episode(world, {.budget = task.budget, .end = end, .action_space = action_space_of(world)});
  episode.reset(task.start);
  std::size_t last_visit = 1;  // length of the walk up to it
  while (!episode.done() && !ticker.tick(episode.visited_count())) {
    const Observation now = episode.observation();
    const int visited = episode.visited_count();
    int action = kStop;
    policy.act({&now, 1}, {&action, 1});
    if (action == kStop) break;
    step(episode, action);
    if (episode.visited_count() > visited) last_visit = episode.walk().size();
  }
  std::vector<NodeId> walk = episode.walk();
  if (task.ends_anywhere()) {
    walk.resize(last_visit);
  } else if (walk.back() != task.end) {
    NearestFirst search;
    search.run(world.open(), walk.back(), kNoLimit, [&](NodeId node, double) {
      return node == task.end ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
    });
    search.append_path_to(task.end, walk);
  }
  return plan_of_walk(task, std::move(walk));
}

}  // namespace graphdrl
