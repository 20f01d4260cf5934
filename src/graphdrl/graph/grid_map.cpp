#include "graphdrl/graph/grid_map.h"

namespace graphdrl {

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
