#include "graphdrl/report/map_drawing.h"

#include <fmt/format.h>

#include <vector>

namespace graphdrl {

std::vector<int> first_visits(const World& world, std::span<const NodeId> walk) {
  std::vector<int> steps(world.graph().node_count(), -1);
  for (std::size_t step = 0; step < walk.size(); ++step) {
    if (steps[walk[step]] < 0) steps[walk[step]] = static_cast<int>(step);
  }
  return steps;
}

std::string draw_map_text(const World& world, std::span<const NodeId> walk) {
  const GridMap& map = *world.map();
  const std::vector<int> visited_at = first_visits(world, walk);
  const std::size_t width = walk.empty() ? 1 : fmt::format("{}", walk.size() - 1).size() + 1;
  std::string text;
  for (int row = 0; row < map.rows; ++row) {
    std::string line;
    for (int col = 0; col < map.cols; ++col) {
      const NodeId node = map.node({row, col});
      const std::string cell = world.is_blocked(node)  ? "#"
                               : visited_at[node] >= 0 ? fmt::format("{}", visited_at[node])
                                                       : ".";
      line += fmt::format("{:>{}}", cell, width);
    }
    text += line.substr(walk.empty() ? 0 : 1) + '\n';
  }
  return text;
}

}  // namespace graphdrl
