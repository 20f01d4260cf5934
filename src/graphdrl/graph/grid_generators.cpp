#include "graphdrl/graph/grid_generators.h"

#include <algorithm>

namespace graphdrl {
namespace {

GridMap blocked_map(int rows, int cols) {
  return {.rows = rows, .cols = cols, .blocked = std::vector<bool>(static_cast<std::size_t>(rows) * cols, true)};
}

// A wall cell between two rooms of a maze.
struct Wall {
  Cell cell;
  Cell one;
  Cell other;
};

// A random spanning tree of the rooms by depth-first search, the usual maze: long corridors, few short dead ends. Gives
// the walls between rooms that stay, in row-major order.
std::vector<Wall> carve_maze(GridMap& map, Rng& rng) {
  std::vector<Cell> trail = {{0, 0}};
  map.blocked[0] = false;
  while (!trail.empty()) {
    const Cell here = trail.back();
    std::vector<Cell> fresh;
    for (const Cell next : {Cell{here.row, here.col - 2}, Cell{here.row - 2, here.col}, Cell{here.row, here.col + 2},
                            Cell{here.row + 2, here.col}}) {
      if (map.contains(next) && map.blocked[map.node(next)]) fresh.push_back(next);
    }
    if (fresh.empty()) {
      trail.pop_back();
      continue;
    }
    const Cell next = fresh[rng.below(static_cast<std::uint32_t>(fresh.size()))];
    map.blocked[map.node({(here.row + next.row) / 2, (here.col + next.col) / 2})] = false;
    map.blocked[map.node(next)] = false;
    trail.push_back(next);
  }
  std::vector<Wall> walls;
  const auto keep = [&](const Wall& wall) {
    if (map.contains(wall.other) && map.blocked[map.node(wall.cell)]) walls.push_back(wall);
  };
  for (int row = 0; row < map.rows; row += 2) {
    for (int col = 0; col < map.cols; col += 2) {
      keep({{row, col + 1}, {row, col}, {row, col + 2}});
      keep({{row + 1, col}, {row, col}, {row + 2, col}});
    }
  }
  return walls;
}

int open_sides(const GridMap& map, Cell cell) {
  int count = 0;
  for (const Direction direction : kAllDirections) {
    const NodeId next = grid_neighbour(map.rows, map.cols, map.node(cell), direction);
    count += next != kNoNode && !map.blocked[next];
  }
  return count;
}

}  // namespace

GridMap largest_component(const GridMap& map) {
  std::vector<int> part(map.blocked.size(), -1);
  std::vector<int> sizes;
  std::vector<NodeId> stack;
  for (NodeId start = 0; start < std::ssize(part); ++start) {
    if (map.blocked[start] || part[start] >= 0) continue;
    const int index = static_cast<int>(sizes.size());
    sizes.push_back(0);
    part[start] = index;
    stack.assign(1, start);
    while (!stack.empty()) {
      const NodeId node = stack.back();
      stack.pop_back();
      ++sizes[index];
      for (const Direction direction : kAllDirections) {
        const NodeId next = grid_neighbour(map.rows, map.cols, node, direction);
        if (next == kNoNode || map.blocked[next] || part[next] >= 0) continue;
        part[next] = index;
        stack.push_back(next);
      }
    }
  }
  const auto largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  GridMap result = map;
  for (std::size_t i = 0; i < part.size(); ++i) result.blocked[i] = part[i] != largest;
  return result;
}

GridMap random_obstacles_map(int rows, int cols, double obstacles, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  for (std::size_t i = 0; i < map.blocked.size(); ++i) map.blocked[i] = rng.uniform() < obstacles;
  return largest_component(map);
}

GridMap maze_map(int rows, int cols, double loops, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  for (const Wall& wall : carve_maze(map, rng)) {
    if (rng.uniform() < loops) map.blocked[map.node(wall.cell)] = false;
  }
  return map;
}

GridMap braided_maze_map(int rows, int cols, double braid, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  const std::vector<Wall> walls = carve_maze(map, rng);
  for (int row = 0; row < rows; row += 2) {
    for (int col = 0; col < cols; col += 2) {
      const Cell room{row, col};
      if (open_sides(map, room) != 1 || !(rng.uniform() < braid)) continue;
      std::vector<Cell> closed;
      for (const Wall& wall : walls) {
        if ((wall.one == room || wall.other == room) && map.blocked[map.node(wall.cell)]) closed.push_back(wall.cell);
      }
      if (closed.empty()) continue;
      map.blocked[map.node(closed[rng.below(static_cast<std::uint32_t>(closed.size()))])] = false;
    }
  }
  return map;
}

GridMap rooms_map(int rows, int cols, int max_room, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  const auto below = [&](int count) { return static_cast<int>(rng.below(static_cast<std::uint32_t>(count))); };
  std::vector<Cell> centres;
  const int rooms = std::max(2, rows * cols / (2 * max_room * max_room));
  for (int i = 0; i < rooms; ++i) {
    const int height = std::min(rows, 2 + below(max_room - 1));
    const int width = std::min(cols, 2 + below(max_room - 1));
    const Cell corner{below(rows - height + 1), below(cols - width + 1)};
    for (int row = corner.row; row < corner.row + height; ++row) {
      for (int col = corner.col; col < corner.col + width; ++col) map.blocked[map.node({row, col})] = false;
    }
    centres.push_back({corner.row + height / 2, corner.col + width / 2});
    if (i == 0) continue;
    // A corridor with one bend from the room before.
    Cell at = centres[static_cast<std::size_t>(i) - 1];
    const Cell to = centres.back();
    const bool row_first = rng.below(2) == 0;
    for (int leg = 0; leg < 2; ++leg) {
      const bool along_rows = row_first == (leg == 0);
      int& here = along_rows ? at.row : at.col;
      const int there = along_rows ? to.row : to.col;
      while (here != there) {
        here += here < there ? 1 : -1;
        map.blocked[map.node(at)] = false;
      }
    }
  }
  return map;
}

}  // namespace graphdrl
