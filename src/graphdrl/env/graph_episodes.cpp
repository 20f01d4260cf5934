#include "graphdrl/env/graph_episodes.h"

#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/base/error.h"
#include "graphdrl/env/feature_rows.h"

namespace graphdrl {
namespace {

constexpr double kDearest = 8;  // mean edges
constexpr int kMostUnvisited = 8;

int most_neighbours(const EpisodesOptions& options) {
  if (!options.world) return options.is_grid() ? kDirectionCount : options.most_nodes() - 1;
  int most = 0;
  for (const NodeId node : options.world->valid_nodes()) most = std::max(most, options.world->open().degree(node));
  return most;
}

// The first four columns.
void write_node(const Episode& episode, NodeId node, std::span<float> row) {
  const auto column = columns<GraphNodeFeature>(row);
  const bool open = !episode.view().is_blocked(node);
  column(GraphNodeFeature::kOpen) = flag(open);
  column(GraphNodeFeature::kVisited) = flag(episode.visits()[node] > 0);
  column(GraphNodeFeature::kCurrent) = flag(episode.position() == node);
  column(GraphNodeFeature::kPrize) = open ? prize_of(episode.view(), node) : 0.0f;
}

void write_action(const Observation& now, int action, std::span<float> row) {
  const auto column = columns<GraphActionFeature>(row);
  const NodeId target = now.target(action);
  const auto around = now.view().open_neighbours(target);
  const auto unvisited = std::ranges::count_if(around, [&](NodeId next) { return !now.visited(next); });
  const double cost = now.cost(action) / now.view().open().mean_cost();
  column(GraphActionFeature::kLegal) = flag(now.legal(action));
  column(GraphActionFeature::kVisited) = flag(now.visited(target));
  column(GraphActionFeature::kCost) = static_cast<float>(std::min(cost, kDearest) / kDearest);
  column(GraphActionFeature::kPrize) = prize_of(now.view(), target);
  column(GraphActionFeature::kUnvisitedNeighbours) =
      static_cast<float>(std::min<std::ptrdiff_t>(unvisited, kMostUnvisited)) / kMostUnvisited;
}

}  // namespace

GraphEpisodes::GraphEpisodes(EpisodesOptions options, int max_neighbours)
    : Episodes(std::move(options), ActionSpace::kNeighbours),
      nodes_(this->options().most_nodes()),
      neighbours_(max_neighbours > 0 ? max_neighbours : std::max(most_neighbours(this->options()), 1)) {
  allocate(std::size_t{kFlatGraphNodeFeatureCount} * nodes_ + std::size_t{kGraphActionFeatureCount} * neighbours_ +
               kGraphFeatureCount,
           neighbours_);
}

GraphObservation GraphEpisodes::graph(int index) const {
  const Episode& at = episode(index);
  const Observation now = at.observation();
  std::vector<float> rows(static_cast<std::size_t>(at.view().node_count()) * kGraphNodeFeatureCount);
  for (NodeId node = 0; node < at.view().node_count(); ++node) {
    const std::span<float> row(rows.data() + std::ptrdiff_t{node} * kGraphNodeFeatureCount, kGraphNodeFeatureCount);
    write_node(at, node, row);
    const int action = now.action_to(node);
    const auto column = columns<GraphNodeFeature>(row);
    column(GraphNodeFeature::kLegal) = flag(action != kNoAction && now.legal(action));
    column(GraphNodeFeature::kBudgetLeft) = budget_left(now);
  }
  return observation_on(at.view().open(), at.view().open().mean_cost(), std::move(rows));
}

void GraphEpisodes::show_start(int index, const Episode& episode) {
  const View& view = episode.view();
  for (const NodeId node : view.valid_nodes()) {
    const auto degree = std::ssize(view.open_neighbours(node));
    if (degree <= neighbours_) continue;
    throw Error({.what = fmt::format("a node of {} neighbours", degree),
                 .expected = fmt::format("at most max_neighbours = {}", neighbours_),
                 .where = view.name()});
  }
  std::ranges::fill(observation_of(index), 0.0f);
  for (NodeId node = 0; node < view.node_count(); ++node) show_node(index, episode, node);
  show_moves(index, episode);
}

Episodes::Outcome GraphEpisodes::take(int index, Episode& episode, int action) {
  Outcome outcome;
  if (mask_of(index)[action]) {
    const NodeId from = episode.position();
    outcome.reward = episode.step(action).reward;
    show_node(index, episode, from);
    show_node(index, episode, episode.position());
  } else {
    outcome = waste(episode);
  }
  show_moves(index, episode);
  outcome.truncated = episode.too_long();
  outcome.terminated =
      outcome.terminated || episode.observation().all_visited() || (episode.done() && !outcome.truncated);
  return outcome;
}

void GraphEpisodes::show_node(int index, const Episode& episode, NodeId node) {
  write_node(episode, node,
             observation_of(index).subspan(static_cast<std::size_t>(node) * kFlatGraphNodeFeatureCount,
                                           kFlatGraphNodeFeatureCount));
}

void GraphEpisodes::show_moves(int index, const Episode& episode) {
  const Observation now = episode.observation();
  const std::span<bool> mask = mask_of(index);
  const std::span<std::int64_t> targets = targets_of(index);
  const std::span<float> moves =
      observation_of(index).subspan(static_cast<std::size_t>(nodes_) * kFlatGraphNodeFeatureCount);
  std::ranges::fill(moves, 0.0f);
  std::ranges::fill(mask, false);
  std::ranges::fill(targets, kNoNode);
  for (int action = 0; action < now.action_count(); ++action) {
    mask[action] = now.legal(action);
    targets[action] = now.target(action);
    write_action(now, action,
                 moves.subspan(static_cast<std::size_t>(action) * kGraphActionFeatureCount, kGraphActionFeatureCount));
  }
  const auto column = columns<GraphFeature>(moves.last(kGraphFeatureCount));
  column(GraphFeature::kBudgetLeft) = budget_left(now);
  column(GraphFeature::kVisited) =
      static_cast<float>(now.visited_count) / static_cast<float>(episode.view().valid_count());
}

}  // namespace graphdrl
