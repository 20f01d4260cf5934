#include "graphdrl/nn/grid_episodes.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {

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

}  // namespace graphdrl
