// Rectangular maps of free and blocked cells, the paper's environments.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/graph.h"
#include "graphdrl/graph/point.h"

namespace graphdrl {

struct Cell {
  int row;
  int col;
  friend bool operator==(const Cell&, const Cell&) = default;
  friend Cell operator+(const Cell& one, const Cell& other) { return {one.row + other.row, one.col + other.col}; }
};

// The paper's action space, in the order of its author's code.
inline constexpr int kDirectionCount = 4;
inline constexpr std::array<std::string_view, kDirectionCount> kDirectionNames = {"left", "up", "right", "down"};
// The steps of these directions, then the diagonal ones, clockwise from left-up.
inline constexpr std::array<Cell, 8> kGridSteps = {
    {{0, -1}, {-1, 0}, {0, 1}, {1, 0}, {-1, -1}, {-1, 1}, {1, 1}, {1, -1}}};

// How a grid lies in the plane.
struct GridFrame {
  double cell_size = 1;  // a side, in `unit`
  Point origin = {};     // the lower left corner of the lower left cell
  double yaw = 0;        // radians, counter-clockwise: how far the grid is turned about its origin
  std::string unit;
};

// Node ids are row-major: node = row * cols + col. Row 0 is the upper one.
struct GridMap {
  int rows = 0;
  int cols = 0;
  std::vector<bool> blocked;  // [rows * cols]
  bool diagonals = false;     // steps lead to eight cells, not four; a diagonal one costs √2
  bool cut_corners = false;   // a diagonal step may have a blocked cell beside it
  std::optional<GridFrame> frame = {};

  NodeId node(Cell cell) const { return cell.row * cols + cell.col; }
  Cell cell(NodeId node) const { return {node / cols, node % cols}; }
  bool contains(Cell cell) const { return cell.row >= 0 && cell.row < rows && cell.col >= 0 && cell.col < cols; }
  // From a cell to its neighbours.
  std::span<const Cell> steps() const { return std::span(kGridSteps).first(diagonals ? 8 : kDirectionCount); }
  bool is_free(Cell cell) const { return contains(cell) && !blocked[node(cell)]; }
  std::int64_t free_count() const { return std::count(blocked.begin(), blocked.end(), false); }

  // The centre of a cell: x to the right, y upward, in the frame's unit; without a frame x is the column and y the row,
  // downward.
  Point place(NodeId node) const;
};

// Blocks every cell whose centre is nearer to a blocked cell than the radius, in sides of a cell. What lies beyond the
// border is no obstacle. Cost: O(cells · radius).
GridMap with_obstacles_grown(GridMap map, double radius);

// Larger cells of `scale` times the side, from the lower left corner; `scale` need not be a whole number. A larger cell
// is free if all cells of the map that it touches are. Cells beyond the last whole larger one are dropped. Keeps the
// frame's corner. REQUIRES: scale >= 1 and at most the shorter side of the map.
GridMap coarsened(const GridMap& map, double scale);

}  // namespace graphdrl
