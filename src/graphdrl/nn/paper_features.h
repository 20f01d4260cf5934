// The seven node features of the paper, section 2.1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/view.h"

namespace graphdrl {

enum class PaperFeature { kX, kY, kObstacle, kVisits, kWall, kUnvisitedNeighbours, kCurrent };
inline constexpr int kPaperFeatureCount = 7;
inline constexpr std::array<std::string_view, kPaperFeatureCount> kPaperFeatureNames = {
    "x", "y", "obstacle", "visits", "wall", "unvisited_neighbours", "current"};

// Builds the features of one world's nodes, unscaled. As in the author's code, x is the row and y the column, and an
// obstacle counts as an unvisited neighbour for ever. Immutable.
class PaperFeatureEncoder {
 public:
  // Throws Error where the world is no grid: x, y and wall need one.
  explicit PaperFeatureEncoder(const View& view);

  const View& view() const { return view_; }

  // out: [N, F]. From scratch: O(N + edges of visited nodes).
  template <typename Count>
  void encode(NodeId position, std::span<const Count> visits, std::span<float> out) const;

  // The same matrix kept up to date: begin() at a start, then update() after every step; O(degree).
  void begin(NodeId start, std::span<float> out) const;
  void update(NodeId from, NodeId to, const StepResult& step, std::span<float> out) const;

 private:
  void mark_visited(NodeId node, std::span<float> out) const;

  View view_;
  std::vector<float> untouched_;  // [N, F], nothing visited, nobody there
};

}  // namespace graphdrl
