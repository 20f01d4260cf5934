#include "graphdrl/graph/grid_map.h"

#include <algorithm>
#include <cmath>

namespace graphdrl {
namespace {

constexpr double kRounding = 1e-9;  // of sides of cells

// How many cells to either side of its column a blocked cell reaches in a row `rows` away; -1 if it does not reach it.
int reach_in_row(int rows, double radius) {
  // From the centre of a cell to the nearest point of another, `cols` columns and `rows` rows away.
  const auto gap = [](int cells) { return std::max(0.0, std::abs(cells) - 0.5); };
  if (gap(rows) >= radius) return -1;
  int cols = 0;
  while (std::hypot(gap(cols + 1), gap(rows)) < radius) ++cols;
  return cols;
}

}  // namespace

Point GridMap::place(NodeId node) const {
  const Cell at = cell(node);
  if (!frame) return {static_cast<double>(at.col), static_cast<double>(at.row)};
  const double right = (at.col + 0.5) * frame->cell_size;
  const double up = (rows - at.row - 0.5) * frame->cell_size;
  const double cosine = std::cos(frame->yaw);
  const double sine = std::sin(frame->yaw);
  return {frame->origin.x + cosine * right - sine * up, frame->origin.y + sine * right + cosine * up};
}

GridMap with_obstacles_grown(GridMap map, double radius) {
  const std::vector<bool> before = map.blocked;
  const int most_rows = static_cast<int>(std::min<double>(std::ceil(radius + 0.5), map.rows));
  // Blocked runs that begin at a column, minus those that end there.
  std::vector<int> starts(static_cast<std::size_t>(map.cols) + 1);
  std::vector<int> reaches;
  for (int rows = 0; rows <= most_rows; ++rows) reaches.push_back(reach_in_row(rows, radius));
  for (int row = 0; row < map.rows; ++row) {
    std::fill(starts.begin(), starts.end(), 0);
    for (int rows = -most_rows; rows <= most_rows; ++rows) {
      const int from = row + rows;
      const int reach = reaches[std::abs(rows)];
      if (from < 0 || from >= map.rows || reach < 0) continue;
      for (int col = 0; col < map.cols; ++col) {
        if (!before[map.node({from, col})]) continue;
        ++starts[std::max(0, col - reach)];
        --starts[std::min(map.cols, col + reach + 1)];
      }
    }
    int covering = 0;
    for (int col = 0; col < map.cols; ++col) {
      covering += starts[col];
      if (covering > 0) map.blocked[map.node({row, col})] = true;
    }
  }
  return map;
}

GridMap coarsened(const GridMap& map, double scale) {
  GridMap coarse{.rows = static_cast<int>(std::floor(map.rows / scale + kRounding)),
                 .cols = static_cast<int>(std::floor(map.cols / scale + kRounding)),
                 .blocked = {},
                 .diagonals = map.diagonals,
                 .cut_corners = map.cut_corners,
                 .frame = map.frame};
  if (coarse.frame) coarse.frame->cell_size *= scale;
  coarse.blocked.resize(static_cast<std::size_t>(coarse.rows) * coarse.cols);
  // The first and the last cell of the map that the i-th larger one touches.
  const auto first = [&](int i) { return static_cast<int>(std::floor(i * scale + kRounding)); };
  const auto last = [&](int i, int cells) {
    return std::min(cells, static_cast<int>(std::ceil((i + 1) * scale - kRounding))) - 1;
  };
  for (int up = 0; up < coarse.rows; ++up) {
    const int row = coarse.rows - 1 - up;
    for (int col = 0; col < coarse.cols; ++col) {
      bool blocked = false;
      for (int fine_up = first(up); fine_up <= last(up, map.rows) && !blocked; ++fine_up) {
        for (int fine = first(col); fine <= last(col, map.cols) && !blocked; ++fine) {
          blocked = map.blocked[map.node({map.rows - 1 - fine_up, fine})];
        }
      }
      coarse.blocked[coarse.node({row, col})] = blocked;
    }
  }
  return coarse;
}

}  // namespace graphdrl
