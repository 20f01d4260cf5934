// The paper's decision process on grids, observed as its features of each cell.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "graphdrl/env/episodes.h"
#include "graphdrl/nn/paper_features.h"

namespace graphdrl {

// An action is a direction [kDirectionNames], A = 4; none is masked or has a target. F = 7 N, 0 where a world has fewer
// cells. An episode is truncated where its budget is spent.
class GridEpisodes final : public Episodes {
 public:
  // Throws Error on worlds that are no grids and on a budget below 1, a step.
  explicit GridEpisodes(EpisodesOptions options);

  // The highest value of each feature; the lowest is 0.
  std::array<float, kPaperFeatureCount> highest_features() const;

 private:
  void show_start(int index, const Episode& episode) override;
  Outcome take(int index, Episode& episode, int action) override;

  std::vector<std::shared_ptr<const PaperFeatureEncoder>> encoders_;  // [V], of each episode's world
};

}  // namespace graphdrl
