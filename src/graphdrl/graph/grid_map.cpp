#include "graphdrl/graph/grid_map.h"

#include <cmath>

namespace graphdrl {

Point GridMap::place(NodeId node) const {
  const Cell at = cell(node);
  if (!frame) return {static_cast<double>(at.col), static_cast<double>(at.row)};
  const double right = (at.col + 0.5) * frame->cell_size;
  const double up = (rows - at.row - 0.5) * frame->cell_size;
  const double cosine = std::cos(frame->yaw);
  const double sine = std::sin(frame->yaw);
  return {frame->origin.x + cosine * right - sine * up, frame->origin.y + sine * right + cosine * up};
}

NodeId grid_neighbour(int rows, int cols, NodeId node, Direction direction) {
  const int row = node / cols;
  const int col = node % cols;
  switch (direction) {
    case Direction::kLeft:
      return col > 0 ? node - 1 : kNoNode;
    case Direction::kUp:
      return row > 0 ? node - cols : kNoNode;
    case Direction::kRight:
      return col + 1 < cols ? node + 1 : kNoNode;
    case Direction::kDown:
      return row + 1 < rows ? node + cols : kNoNode;
  }
  return kNoNode;
}

}  // namespace graphdrl
