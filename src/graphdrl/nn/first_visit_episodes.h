// The decision process on any graph, from first visit to first visit, observed as the explorer sees it.
#pragma once

#include <vector>

#include "graphdrl/env/episodes.h"
#include "graphdrl/nn/explorer_features.h"

namespace graphdrl {

// Columns of a row for each action.
enum class FirstVisitFeature {
  kExists,    // flag
  kExplorer,  // the first of kExplorerVisitFeatures, the others after it
};
inline constexpr int kFirstVisitFeatureCount = 1 + kExplorerVisitFeatureCount;
inline constexpr float kMostExplorerFeature = 16;  // features are cut at ±16

// An action is a walk to an unvisited node next to visited ones, by the cheapest way through visited nodes; the nearest
// ones, nearest first. A masked action is a waste(). An episode terminates where no first visit can be paid for.
// F = 12 A.
class FirstVisitEpisodes final : public Episodes {
 public:
  // most_visits: A.
  FirstVisitEpisodes(EpisodesOptions options, int most_visits);

  GraphObservation graph(int index) const;                 // of the nodes around the current one. nodes: [N, 20]
  std::vector<std::int64_t> target_rows(int index) const;  // [A], rows in that graph, kNoNode for masked actions

 private:
  struct Memory {
    NodeSet visited;
    ExplorerScratch scratch;
    NearestFirst search;
    ExplorerBatch seen;
    std::vector<FirstVisit> visits;
  };

  void show_start(int index, const Episode& episode) override;
  Outcome take(int index, Episode& episode, int action) override;
  void show(int index, const Episode& episode);

  int most_visits_;
  std::vector<Memory> memories_;  // [V]
};

}  // namespace graphdrl
