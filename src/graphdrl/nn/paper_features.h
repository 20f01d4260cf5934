// The seven node features of the paper, section 2.1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/view.h"

namespace graphdrl {

enum class PaperFeature { kX, kY, kObstacle, kVisits, kWall, kUnvisitedNeighbours, kCurrent };
inline constexpr int kPaperFeatureCount = 7;
inline constexpr std::array<std::string_view, kPaperFeatureCount> kPaperFeatureNames = {
    "x", "y", "obstacle", "visits", "wall", "unvisited_neighbours", "current"};

// Which nodes have the feature wall. A network must see it as in its training, so policy files say which.
enum class PaperWall {
  kBorder,      // the map's first and last rows and columns: the paper's "perimetral wall"
  kZeroOrNine,  // rows and columns 0 and 9, of maps of any size: the author's code
};
inline constexpr std::array<std::string_view, 2> kPaperWallNames = {"border", "zero_or_nine"};

std::string_view name_of(PaperWall wall);
// Throws Error for another name, naming the source if there is one.
PaperWall parse_paper_wall(std::string_view name, const std::string& source = "");

// Builds the features of one world's nodes, unscaled. As in the author's code, x is the row and y the column, and an
// obstacle counts as an unvisited neighbour for ever. Immutable.
class PaperFeatureEncoder {
 public:
  // Throws Error where the world is no grid: x, y and wall need one.
  explicit PaperFeatureEncoder(const View& view, PaperWall wall = PaperWall::kBorder);

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
  std::vector<float> untouched_;  // [N, F], nothing visited, no current node
};

}  // namespace graphdrl
