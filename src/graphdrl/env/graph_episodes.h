// The decision process on any graph, edge by edge.
#pragma once

#include <span>

#include "graphdrl/env/episodes.h"

namespace graphdrl {

// Columns of what is observed. Flags are 0 or 1; prizes are cut at 8 mean prizes, costs at 8 mean edges and counts at
// 8, and divided by that. Flat observations have the first four of each node.
enum class GraphNodeFeature { kOpen, kVisited, kCurrent, kPrize, kLegal, kBudgetLeft };
enum class GraphActionFeature { kLegal, kVisited, kCost, kPrize, kUnvisitedNeighbours };
enum class GraphFeature { kBudgetLeft, kVisited };  // as shares
inline constexpr int kGraphNodeFeatureCount = 6;
inline constexpr int kFlatGraphNodeFeatureCount = 4;
inline constexpr int kGraphActionFeatureCount = 5;
inline constexpr int kGraphFeatureCount = 2;

// An action is a neighbour of the current node, in ascending order; a masked one is a waste(). An episode terminates
// where nothing can be paid for or everything is visited; it is truncated where it goes on for too long
// [Episode::too_long]. F = 4 N + 5 A + 2: rows of nodes, rows of actions, and the shares; 0 where a world has fewer.
class GraphEpisodes final : public Episodes {
 public:
  // max_neighbours: A; 0 for as many as the worlds may need. A world that needs more throws Error when it begins.
  explicit GraphEpisodes(EpisodesOptions options, int max_neighbours = 0);

  GraphObservation graph(int index) const;  // nodes: [N, 6]

 private:
  void show_start(int index, const Episode& episode) override;
  Outcome take(int index, Episode& episode, int action) override;
  void show_node(int index, const Episode& episode, NodeId node);
  void show_moves(int index, const Episode& episode);

  int nodes_;
  int neighbours_;
};

}  // namespace graphdrl
