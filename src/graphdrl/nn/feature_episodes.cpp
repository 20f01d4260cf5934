#include "graphdrl/nn/feature_episodes.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

float cut(float value) {
  return std::clamp(value, -kMostExplorerFeature, kMostExplorerFeature);
}

}  // namespace

GridEpisodes::GridEpisodes(EpisodesOptions options)
    : Episodes(std::move(options), ActionSpace::kDirections), encoders_(static_cast<std::size_t>(count())) {
  Rng rng(0);
  const World example = this->options().draw_world(rng);
  if (!(this->options().budget.cost_in(example) >= 1)) {
    throw Error({.what = "bad budget", .expected = "1 or more, for a step"});
  }
  allocate(static_cast<std::size_t>(this->options().most_nodes()) * kPaperFeatureCount, kDirectionCount);
  std::ranges::fill(action_masks(), true);
  if (this->options().world) std::ranges::fill(encoders_, std::make_shared<const PaperFeatureEncoder>(example));
}

std::array<float, kPaperFeatureCount> GridEpisodes::highest_features() const {
  const int side = options().family.size;
  const GridMap open{.rows = side, .cols = side, .blocked = std::vector<bool>(static_cast<std::size_t>(side) * side)};
  const World largest = options().world ? *options().world : World("", open);
  const auto last_row = static_cast<float>(std::max(largest.map()->rows - 1, 1));
  const auto last_column = static_cast<float>(std::max(largest.map()->cols - 1, 1));
  const auto most_visits = static_cast<float>(options().budget.cost_in(largest) + 1);
  return {last_row, last_column, /*obstacle=*/1, most_visits, /*wall=*/1, /*unvisited_neighbours=*/4, /*current=*/1};
}

void GridEpisodes::show_start(int index, const Episode& episode) {
  auto& encoder = encoders_[index];
  const std::span<float> out = observation_of(index);
  if (encoder == nullptr || !(encoder->view() == episode.view())) {
    encoder = std::make_shared<const PaperFeatureEncoder>(episode.view());
    std::ranges::fill(out, 0.0f);  // the world before may have had more cells
  }
  encoder->begin(episode.position(), out);
}

Episodes::Outcome GridEpisodes::take(int index, Episode& episode, int action) {
  const NodeId from = episode.position();
  const StepResult step = episode.step(action);
  encoders_[index]->update(from, episode.position(), step, observation_of(index));
  return {.reward = step.reward, .terminated = episode.terminal(), .truncated = episode.done()};
}

FirstVisitEpisodes::FirstVisitEpisodes(EpisodesOptions options, int most_visits)
    : Episodes(std::move(options), ActionSpace::kNeighbours),
      most_visits_(most_visits),
      memories_(static_cast<std::size_t>(count())) {
  allocate(std::size_t{kFirstVisitFeatureCount} * most_visits, most_visits);
}

GraphObservation FirstVisitEpisodes::graph(int index) const {
  const double mean_cost = episode(index).view().open().mean_cost();
  const ExplorerBatch& seen = memories_[index].seen;
  std::vector<float> rows = seen.node_x;
  std::ranges::transform(rows, rows.begin(), cut);
  return observation_on(seen.graphs.graph(0), mean_cost, std::move(rows));
}

std::vector<std::int64_t> FirstVisitEpisodes::target_rows(int index) const {
  const Memory& memory = memories_[index];
  std::vector<std::int64_t> rows(memory.seen.target.begin(), memory.seen.target.end());
  rows.resize(static_cast<std::size_t>(most_visits_), kNoNode);
  return rows;
}

Episodes::Outcome FirstVisitEpisodes::take(int index, Episode& episode, int action) {
  Memory& memory = memories_[index];
  Outcome outcome;
  if (mask_of(index)[action]) {
    const NodeId target = memory.visits[action].node;
    find_way(episode.view().open(), episode.position(), target, episode.observation().ground(), memory.search);
    std::vector<NodeId> way;  // without the current node
    memory.search.append_path_to(target, way);
    for (const NodeId node : way) {
      outcome.reward += episode.step(episode.observation().action_to(node)).reward;
    }
  } else {
    outcome = waste(episode);
  }
  show(index, episode);
  outcome.terminated = outcome.terminated || memory.visits.empty();
  return outcome;
}

void FirstVisitEpisodes::show(int index, const Episode& episode) {
  Memory& memory = memories_[index];
  const Observation now = episode.observation();
  memory.seen.clear();
  const Exploration state(now, now.ground());
  const auto [visits, left_out] = encode(state, memory.scratch, memory.seen);
  memory.visits.assign(visits.begin(), visits.end());
  if (visits.empty() && left_out) {
    // The nearest, when all are out of scope.
    const FirstVisit far = state.nearest_first_visit(memory.search);
    if (far.node != kNoNode) memory.visits.push_back(far);
  }
  const std::span<bool> mask = mask_of(index);
  const std::span<std::int64_t> targets = targets_of(index);
  const std::span<float> out = observation_of(index);
  std::ranges::fill(mask, false);
  std::ranges::fill(targets, kNoNode);
  std::ranges::fill(out, 0.0f);
  for (std::size_t v = 0; v < std::min(memory.visits.size(), mask.size()); ++v) {
    mask[v] = true;
    targets[v] = memory.visits[v].node;
    const std::span<float> row = out.subspan(v * kFirstVisitFeatureCount, kFirstVisitFeatureCount);
    row[static_cast<std::size_t>(FirstVisitFeature::kExists)] = 1;
    if (v == memory.seen.target.size()) break;  // the far one, of which nothing is seen
    const auto features =
        std::span(memory.seen.visit_x).subspan(v * kExplorerVisitFeatureCount, kExplorerVisitFeatureCount);
    std::ranges::transform(features, row.begin() + static_cast<int>(FirstVisitFeature::kExplorer), cut);
  }
}

}  // namespace graphdrl
