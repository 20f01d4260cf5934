// Rectangular maps of free and blocked cells, the paper's environments.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "graphdrl/graph/graph.h"

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

// Node ids are row-major: node = row * cols + col.
struct GridMap {
  int rows = 0;
  int cols = 0;
  std::vector<bool> blocked;  // [rows * cols]

  NodeId node(Cell cell) const { return cell.row * cols + cell.col; }
  Cell cell(NodeId node) const { return {node / cols, node % cols}; }
  bool contains(Cell cell) const { return cell.row >= 0 && cell.row < rows && cell.col >= 0 && cell.col < cols; }
};

// The node one step away, blocked or not; kNoNode beyond the border.
NodeId grid_neighbour(int rows, int cols, NodeId node, Direction direction);

}  // namespace graphdrl
