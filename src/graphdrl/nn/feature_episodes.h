// Decision processes observed as the networks see them: the paper's on grids, and that from first visit to first visit.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "graphdrl/env/episodes.h"
#include "graphdrl/nn/explorer_features.h"
#include "graphdrl/nn/paper_features.h"

namespace graphdrl {

// The paper's, observed as its features of each cell. An action is a direction [kDirectionNames], A = 4; none is masked
// or has a target. F = 7 N, 0 where a world has fewer cells. An episode is truncated where its budget is spent.
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

// Columns of a row for each action.
enum class FirstVisitFeature {
  kExists,    // flag
  kExplorer,  // the first of kExplorerVisitFeatures, the others after it
};
inline constexpr int kFirstVisitFeatureCount = 1 + kExplorerVisitFeatureCount;
inline constexpr float kMostExplorerFeature = 16;  // features are cut at ±16

// The one on any graph, observed as the explorer sees it. An action is a walk to an unvisited node next to visited
// ones, by the cheapest way through visited nodes; the nearest ones, nearest first. A masked action is a waste(). An
// episode terminates where no first visit can be paid for. F = 12 A.
class FirstVisitEpisodes final : public Episodes {
 public:
  // most_visits: A.
  FirstVisitEpisodes(EpisodesOptions options, int most_visits);

  GraphObservation graph(int index) const;                 // of the nodes around the current one. nodes: [N, 20]
  std::vector<std::int64_t> target_rows(int index) const;  // [A], rows in that graph, kNoNode for masked actions

 private:
  struct Memory {
    ExplorerScratch scratch;
    NearestFirst search;
    ExplorerBatch seen;
    std::vector<FirstVisit> visits;
  };

  void show_start(int index, const Episode& episode) override { show(index, episode); }
  Outcome take(int index, Episode& episode, int action) override;
  void show(int index, const Episode& episode);

  int most_visits_;
  std::vector<Memory> memories_;  // [V]
};

}  // namespace graphdrl
