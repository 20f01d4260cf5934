#include "graphdrl/report/map_drawing.h"

#include <vector>

namespace graphdrl {

std::vector<int> first_visits(const World& world, std::span<const NodeId> walk) {
  std::vector<int> steps(world.node_count(), -1);
  for (std::size_t step = 0; step < walk.size(); ++step) {
    if (steps[walk[step]] < 0) steps[walk[step]] = static_cast<int>(step);
  }
  return steps;
}

std::string draw_map_text(const World& world) {
  const GridMap& map = *world.map();
  std::string text;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) text += world.is_blocked(map.node({row, col})) ? '#' : '.';
    text += '\n';
  }
  return text;
}

}  // namespace graphdrl
