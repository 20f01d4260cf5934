// Rectangular maps of free and blocked cells, the paper's environments.
#pragma once

#include <array>
#include <optional>
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
};

// The paper's action space, in the order of its author's code.
enum class Direction { kLeft, kUp, kRight, kDown };
inline constexpr std::array kAllDirections = {Direction::kLeft, Direction::kUp, Direction::kRight, Direction::kDown};
inline constexpr std::array<std::string_view, 4> kDirectionNames = {"left", "up", "right", "down"};

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

  GridMap without_obstacles() const {
    GridMap map = *this;
    map.blocked.assign(map.blocked.size(), false);
    return map;
  }

  NodeId node(Cell cell) const { return cell.row * cols + cell.col; }
  Cell cell(NodeId node) const { return {node / cols, node % cols}; }
  bool contains(Cell cell) const { return cell.row >= 0 && cell.row < rows && cell.col >= 0 && cell.col < cols; }

  // The centre of a cell: x to the right, y upward, in the frame's unit; without a frame x is the column and y the row,
  // downward.
  Point place(NodeId node) const;
};

// The node one step away, blocked or not; kNoNode beyond the border.
NodeId grid_neighbour(int rows, int cols, NodeId node, Direction direction);

}  // namespace graphdrl
