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

// Nodes next to ground from which no way to the end is known.
int count_without_way_back(const Observation& now) {
  if (now.task->ends_anywhere()) return 0;
  const auto is_left = [&](NodeId node) {
    return !now.ground().contains(node) && now.task->cost_to_end(node) == kNoLimit &&
           std::ranges::any_of(now.view().into().neighbours(node),
                               [&](NodeId before) { return now.ground().contains(before); });
  };
  return static_cast<int>(std::ranges::count_if(now.view().valid_nodes(), is_left));
}

}  // namespace

int block_size(const World& world) {
  return static_cast<int>(std::clamp<std::int64_t>(kMostNodesInBlock / world.node_count(), 1, kMostInBlock));
}

std::vector<RolloutResult> roll_out(const Episode& episode, std::span<const NodeId> starts, Policy& policy,
                                    const Clock& clock, std::span<const int> places) {
  std::vector<Episode> episodes(starts.size(), episode);
  std::vector<int> running;
  for (int i = 0; i < std::ssize(starts); ++i) {
    episodes[i].reset(starts[i], static_cast<std::uint64_t>(places.empty() ? i : places[i]));
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
  for (const Episode& ended : episodes) results.push_back({ended.walk_in_world(), ended.prize(), ended.spent()});
  return results;
}

Plan plan_by_steps(const World& world, const Task& task, const EpisodeOptions& options, Policy& policy,
                   const Clock& clock, double think_s, Discovered* discovered) {
  Ticker ticker(clock, /*every=*/1);  // a step may take as long as the policy likes
  Episode episode(world, task, options);
  std::vector<int> known = {episode.view().valid_count()};
  const auto step_on = [&](int action) {
    step(episode, action);
    known.push_back(episode.view().valid_count());
  };
  std::size_t last_gain = 1;  // length of the walk up to it
  double prize = episode.prize();
  while (!episode.done() && !ticker.tick(episode.visited_count())) {
    const Observation now = episode.observation();
    int action = kStop;
    policy.act({&now, 1}, {&action, 1}, think_s < kNoLimit ? clock.at_most(think_s) : clock);
    if (action == kStop) break;
    const int visited = episode.visited_count();
    step_on(action);
    if (episode.visited_count() == visited && episode.prize() <= prize) continue;
    last_gain = episode.walk().size();
    prize = episode.prize();
  }
  const NodeId end = episode.task().end();
  if (end != kNoNode && end != episode.position()) {
    std::vector<NodeId> way = {episode.position()};
    NearestFirst search;
    append_way_to_end(episode.task(), way, search);
    for (std::size_t i = 1; i < way.size(); ++i) step_on(episode.observation().action_to(way[i]));
  }
  std::vector<NodeId> walk = episode.walk_in_world();
  if (task.ends_anywhere()) walk.resize(last_gain);
  if (discovered != nullptr) {
    if (episode.hidden()) discovered->no_way_back = count_without_way_back(episode.observation());
    known.resize(walk.size());
    discovered->after_step = std::move(known);
    for (NodeId node = 0; node < discovered->after_step.back(); ++node) {
      discovered->nodes.push_back(episode.in_world(node));
    }
  }
  Plan plan = plan_of_walk(task, std::move(walk));
  if (options.score == Score::kSeen) plan.prize = episode.prize();
  return plan;
}

}  // namespace graphdrl
