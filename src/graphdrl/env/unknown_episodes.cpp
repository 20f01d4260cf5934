#include "graphdrl/env/unknown_episodes.h"

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/env/exploration.h"
#include "graphdrl/env/feature_rows.h"

namespace graphdrl {
namespace {

constexpr std::ptrdiff_t kMostNeighbours = 8;
constexpr double kHalfWay = 8;  // mean edges, or visits

// 0 of 0, 1/2 of kHalfWay, 1 of infinity.
float squashed(double value) {
  return value < kNoLimit ? static_cast<float>(value / (value + kHalfWay)) : 1.0f;
}

float up_to_most(std::ptrdiff_t neighbours) {
  return static_cast<float>(std::min(neighbours, kMostNeighbours)) / static_cast<float>(kMostNeighbours);
}

// The first seven columns.
void write_known_node(const Observation& now, NodeId node, double distance, bool action, std::span<float> row) {
  const View& view = now.view();
  const auto into = view.into().neighbours(node);
  const auto visited = std::ranges::count_if(into, [&](NodeId next) { return now.visited(next); });
  const auto column = columns<UnknownNodeFeature>(row);
  column(UnknownNodeFeature::kAction) = flag(action);
  column(UnknownNodeFeature::kFrontier) = flag(view.is_frontier(node));
  column(UnknownNodeFeature::kPrize) = prize_of(view, node);
  column(UnknownNodeFeature::kDegree) = up_to_most(std::ssize(view.both_ways().neighbours(node)));
  column(UnknownNodeFeature::kVisitedNeighbours) = up_to_most(visited);
  column(UnknownNodeFeature::kDistance) = squashed(distance / view.open().mean_cost());
  column(UnknownNodeFeature::kUnseenFor) = squashed(static_cast<double>(view.version() - view.seen_at(node)));
}

}  // namespace

UnknownEpisodes::UnknownEpisodes(EpisodesOptions options, int most_visits)
    : Episodes(std::move(options), ActionSpace::kNeighbours),
      memories_(static_cast<std::size_t>(count())),
      seen_(static_cast<std::size_t>(count())) {
  if (this->options().episode.reveal.all()) {
    throw Error({.what = "bad reveal", .expected = "edges, radius:R or sight:R with R above 0", .got = "all"});
  }
  allocate(std::size_t{kFlatUnknownNodeFeatureCount} * most_visits + kUnknownFeatureCount, most_visits);
}

GraphObservation UnknownEpisodes::graph(int index) {
  const Observation now = episode(index).observation();
  const View& view = now.view();
  std::vector<double> distances(view.node_count(), kNoLimit);
  distances[now.position] = 0;
  NearestFirst search;
  search.run(view.open(), now.position, kNoLimit, [&](NodeId node, double cost) {
    distances[node] = cost;
    return now.ground().contains(node) ? NearestFirst::Next::kThrough : NearestFirst::Next::kPast;
  });
  std::vector<bool> is_target(view.node_count());
  for (const std::int64_t target : targets_of(index)) {
    if (target != kNoNode) is_target[target] = true;
  }
  std::vector<float> rows(static_cast<std::size_t>(view.node_count()) * kUnknownNodeFeatureCount);
  for (NodeId node = 0; node < view.node_count(); ++node) {
    const std::span<float> row(rows.data() + std::ptrdiff_t{node} * kUnknownNodeFeatureCount, kUnknownNodeFeatureCount);
    write_known_node(now, node, distances[node], is_target[node], row);
    const auto column = columns<UnknownNodeFeature>(row);
    column(UnknownNodeFeature::kVisited) = flag(now.visited(node));
    column(UnknownNodeFeature::kCurrent) = flag(node == now.position);
    column(UnknownNodeFeature::kBudgetLeft) = budget_left(now);
  }
  return observation_on(view.open(), view.open().mean_cost(), std::move(rows));
}

void UnknownEpisodes::show_start(int index, const Episode& episode) {
  show(index, episode);
}

Episodes::Outcome UnknownEpisodes::take(int index, Episode& episode, int action) {
  Outcome outcome;
  if (mask_of(index)[action]) {
    Memory& memory = memories_[index];
    memory.way.clear();
    memory.search.append_path_to(static_cast<NodeId>(targets_of(index)[action]), memory.way);
    for (const NodeId node : memory.way) {
      const Observation now = episode.observation();
      const int step = now.action_to(node);
      if (!now.affordable(step)) break;
      outcome.reward += episode.step(step).reward;
    }
  } else {
    outcome = waste(episode);
  }
  const int visits = show(index, episode);
  outcome.truncated = episode.too_long();
  outcome.terminated = outcome.terminated || visits == 0;
  return outcome;
}

// Gives how many actions there are. The search stays as it is for the ways there.
int UnknownEpisodes::show(int index, const Episode& episode) {
  const Observation now = episode.observation();
  const std::span<bool> mask = mask_of(index);
  const std::span<std::int64_t> targets = targets_of(index);
  const std::span<float> out = observation_of(index);
  std::ranges::fill(mask, false);
  std::ranges::fill(targets, kNoNode);
  std::ranges::fill(out, 0.0f);
  std::size_t visits = 0;
  const Exploration state(now, now.ground());
  const auto add = [&](NodeId node, double cost) {
    mask[visits] = true;
    targets[visits] = node;
    write_known_node(now, node, cost, /*action=*/true,
                     out.subspan(visits * kFlatUnknownNodeFeatureCount, kFlatUnknownNodeFeatureCount));
    return ++visits < mask.size();
  };
  state.for_first_visits(memories_[index].search, add, [](double) { return true; });
  const auto column = columns<UnknownFeature>(out.last(kUnknownFeatureCount));
  column(UnknownFeature::kBudgetLeft) = budget_left(now);
  column(UnknownFeature::kFree) = squashed(std::max(state.free_to_spend(), 0.0) / now.view().open().mean_cost());
  seen_[index] = now.view().valid_count();
  return static_cast<int>(visits);
}

}  // namespace graphdrl
