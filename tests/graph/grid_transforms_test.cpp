#include "graphdrl/graph/grid_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

GridMap random_map(int rows, int cols, double share, Rng& rng) {
  GridMap map{.rows = rows, .cols = cols, .blocked = std::vector<bool>(static_cast<std::size_t>(rows) * cols)};
  for (std::size_t i = 0; i < map.blocked.size(); ++i) map.blocked[i] = rng.uniform() < share;
  return map;
}

// From the centre of one cell to the nearest point of another.
double distance(Cell from, Cell to) {
  const double rows = std::max(0.0, std::abs(from.row - to.row) - 0.5);
  const double cols = std::max(0.0, std::abs(from.col - to.col) - 0.5);
  return std::hypot(rows, cols);
}

TEST(GridTransforms, ObstaclesGrowByARadius) {
  Rng rng(1);
  for (const double radius : {0.4, 0.6, 1.0, 1.7, 3.2, 40.0}) {
    const GridMap map = random_map(9, 13, 0.03, rng);
    const GridMap grown = with_obstacles_grown(map, radius);
    for (NodeId node = 0; node < 9 * 13; ++node) {
      bool near = map.blocked[node];
      for (NodeId other = 0; other < 9 * 13; ++other) {
        near = near || (map.blocked[other] && distance(map.cell(node), map.cell(other)) < radius);
      }
      ASSERT_EQ(grown.blocked[node], near) << radius;
    }
  }
}

TEST(GridTransforms, LargerCellsAreFreeWhereAllTheyTouchIs) {
  Rng rng(2);
  for (const double scale : {1.0, 1.5, 2.0, 3.3, 4.0}) {
    const GridMap map = random_map(10, 14, 0.1, rng);
    const GridMap coarse = coarsened(map, scale);
    ASSERT_EQ(coarse.rows, std::floor(10 / scale));
    ASSERT_EQ(coarse.cols, std::floor(14 / scale));
    for (NodeId node = 0; node < coarse.rows * coarse.cols; ++node) {
      const Cell cell = coarse.cell(node);
      const double bottom = (coarse.rows - 1 - cell.row) * scale;
      const double left = cell.col * scale;
      bool blocked = false;
      for (NodeId fine = 0; fine < 10 * 14; ++fine) {
        const double up = 9 - map.cell(fine).row;
        const double right = map.cell(fine).col;
        const bool touches = up + 1 > bottom + 1e-6 && up < bottom + scale - 1e-6 && right + 1 > left + 1e-6 &&
                             right < left + scale - 1e-6;
        blocked = blocked || (touches && map.blocked[fine]);
      }
      ASSERT_EQ(coarse.blocked[node], blocked) << scale;
    }
  }
}

TEST(GridTransforms, DiagonalStepsFollowTheFourDirections) {
  GridMap map{.rows = 3, .cols = 3, .blocked = std::vector<bool>(9), .diagonals = true};
  const Graph open = Graph::grid(map);
  EXPECT_EQ(std::vector<NodeId>(open.neighbours(4).begin(), open.neighbours(4).end()),
            (std::vector<NodeId>{3, 1, 5, 7, 0, 2, 8, 6}));
  EXPECT_EQ(open.cost(4, 3), 1);
  EXPECT_EQ(open.cost(4, 4), std::numbers::sqrt2);
  EXPECT_EQ(open.edge_count(), 20);
  for (NodeId next = 0; next < 9; ++next) {
    if (next == 4) continue;
    EXPECT_EQ(open.neighbours(4)[open.index_of(4, next)], next);
  }
  map.blocked[1] = true;  // above the middle
  const Graph careful = Graph::grid(map);
  EXPECT_EQ(careful.index_of(4, 0), -1);
  EXPECT_EQ(careful.index_of(0, 4), -1);
  EXPECT_NE(careful.index_of(4, 6), -1);
  map.cut_corners = true;
  const Graph bold = Graph::grid(map);
  EXPECT_NE(bold.index_of(4, 0), -1);
  EXPECT_EQ(bold.index_of(4, 1), -1);
}

}  // namespace
}  // namespace graphdrl
