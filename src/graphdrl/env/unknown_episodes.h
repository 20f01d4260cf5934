// The decision process on maps that are not known beforehand, from first visit to first visit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/env/episodes.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// Columns of what is observed of a node. Flags are 0 or 1. Prizes and counts are cut at 8 and divided by that; prizes
// are in mean prizes. x / (x + 8) of distances in mean edges, and of visits. Means are of what is known. Flat
// observations have the first seven, of the nodes that actions lead to.
enum class UnknownNodeFeature {
  kAction,    // an action leads there
  kFrontier,  // more edges may lead on from it
  kPrize,
  kDegree,  // edges known
  kVisitedNeighbours,
  kDistance,   // from the position through ground; 1 where there is no way
  kUnseenFor,  // first visits since it was seen last
  kVisited,
  kCurrent,
  kBudgetLeft,  // as a share
};
inline constexpr int kUnknownNodeFeatureCount = 10;
inline constexpr int kFlatUnknownNodeFeatureCount = 7;
enum class UnknownFeature {
  kBudgetLeft,  // as a share
  kFree,        // what is left beyond the way to the end, as distances
};
inline constexpr int kUnknownFeatureCount = 2;

// An action is a walk to a node that is known but no ground yet [HiddenWorld::ground()], by the cheapest way through
// ground: the nearest ones, nearest first. It goes all the way, or as far as can be paid for once an end that came into
// sight is farther. A masked action is a waste(). An episode terminates where no first visit can be paid for. Nodes are
// known by their numbers, other ones in each episode. F = 7 A + 2: rows of actions, and what is left.
class UnknownEpisodes final : public Episodes {
 public:
  // most_visits: A. Throws Error on a map that is known beforehand.
  UnknownEpisodes(EpisodesOptions options, int most_visits);

  GraphObservation graph(int index);                // of what is known. nodes: [N, 10]
  std::span<std::int64_t> seen() { return seen_; }  // [V], how many nodes

 private:
  struct Memory {
    NearestFirst search;
    std::vector<NodeId> way;
  };

  void show_start(int index, const Episode& episode) override;
  Outcome take(int index, Episode& episode, int action) override;
  int show(int index, const Episode& episode);

  std::vector<Memory> memories_;  // [V]
  std::vector<std::int64_t> seen_;
};

}  // namespace graphdrl
