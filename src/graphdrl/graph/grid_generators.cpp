#include "graphdrl/graph/grid_generators.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

// The frozen splits join rooms in the order drawn up to this size; the corridors are as long as the map is wide.
constexpr int kMostCellsJoinedAsDrawn = 500 * 500;

GridMap blocked_map(int rows, int cols) {
  return {.rows = rows, .cols = cols, .blocked = std::vector<bool>(static_cast<std::size_t>(rows) * cols, true)};
}

// A random spanning tree of the rooms by depth-first search, the usual maze: long corridors, few short dead ends.
void carve_maze(GridMap& map, Rng& rng) {
  std::vector<Cell> trail = {{0, 0}};
  map.blocked[0] = false;
  while (!trail.empty()) {
    const Cell here = trail.back();
    std::array<Cell, kAllDirections.size()> fresh;
    std::uint32_t count = 0;
    for (const Cell next : {Cell{here.row, here.col - 2}, Cell{here.row - 2, here.col}, Cell{here.row, here.col + 2},
                            Cell{here.row + 2, here.col}}) {
      if (map.contains(next) && map.blocked[map.node(next)]) fresh[count++] = next;
    }
    if (count == 0) {
      trail.pop_back();
      continue;
    }
    const Cell next = fresh[rng.below(count)];
    map.blocked[map.node({(here.row + next.row) / 2, (here.col + next.col) / 2})] = false;
    map.blocked[map.node(next)] = false;
    trail.push_back(next);
  }
}

// Whether a cell beside a room is a wall with another room behind it.
bool parts_rooms(const GridMap& map, Cell cell) {
  if (!map.contains(cell) || !map.blocked[map.node(cell)]) return false;
  return cell.row % 2 == 0 ? cell.col + 1 < map.cols : cell.row + 1 < map.rows;
}

int open_sides(const GridMap& map, Cell cell) {
  int count = 0;
  for (const Direction direction : kAllDirections) {
    const NodeId next = grid_neighbour(map.rows, map.cols, map.node(cell), direction);
    count += next != kNoNode && !map.blocked[next];
  }
  return count;
}

// Draws a rectangle of 2 to max_room cells a side, frees its cells and gives the middle one.
Cell dig_room(GridMap& map, int max_room, Rng& rng) {
  const auto below = [&](int count) { return static_cast<int>(rng.below(static_cast<std::uint32_t>(count))); };
  const int height = std::min(map.rows, 2 + below(max_room - 1));
  const int width = std::min(map.cols, 2 + below(max_room - 1));
  const int top = below(map.rows - height + 1);
  const int left = below(map.cols - width + 1);
  for (int row = top; row < top + height; ++row) {
    for (int col = left; col < left + width; ++col) map.blocked[map.node({row, col})] = false;
  }
  return {top + height / 2, left + width / 2};
}

// Frees the cells of a corridor with at most one bend.
void dig_corridor(GridMap& map, Cell at, Cell to, Rng& rng) {
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

// Sorts cells so that the next one is near: strip after strip of rows, to and fro.
void sort_by_strips(std::vector<Cell>& cells, int strip_rows) {
  std::sort(cells.begin(), cells.end(), [&](Cell one, Cell other) {
    const int strip = one.row / strip_rows;
    if (strip != other.row / strip_rows) return strip < other.row / strip_rows;
    if (one.col != other.col) return (one.col < other.col) == (strip % 2 == 0);
    return one.row < other.row;
  });
}

}  // namespace

GridMap largest_component(const GridMap& map) {
  const Components components = find_components(map);
  const int largest = components.largest();
  GridMap result = map;
  for (std::size_t i = 0; i < result.blocked.size(); ++i) {
    result.blocked[i] = map.blocked[i] || components.of[i] != largest;
  }
  return result;
}

GridMap random_obstacles_map(int rows, int cols, double obstacles, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  for (std::size_t i = 0; i < map.blocked.size(); ++i) map.blocked[i] = rng.uniform() < obstacles;
  return largest_component(map);
}

GridMap maze_map(int rows, int cols, double loops, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  carve_maze(map, rng);
  for (int row = 0; row < rows; row += 2) {
    for (int col = 0; col < cols; col += 2) {
      for (const Cell wall : {Cell{row, col + 1}, Cell{row + 1, col}}) {
        if (parts_rooms(map, wall) && rng.uniform() < loops) map.blocked[map.node(wall)] = false;
      }
    }
  }
  return map;
}

GridMap braided_maze_map(int rows, int cols, double braid, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  carve_maze(map, rng);
  for (int row = 0; row < rows; row += 2) {
    for (int col = 0; col < cols; col += 2) {
      if (open_sides(map, {row, col}) != 1 || !(rng.uniform() < braid)) continue;
      std::array<Cell, kAllDirections.size()> closed;
      std::uint32_t count = 0;
      for (const Cell wall : {Cell{row - 1, col}, Cell{row, col - 1}, Cell{row, col + 1}, Cell{row + 1, col}}) {
        if (parts_rooms(map, wall)) closed[count++] = wall;
      }
      if (count > 0) map.blocked[map.node(closed[rng.below(count)])] = false;
    }
  }
  return map;
}

GridMap rooms_map(int rows, int cols, int max_room, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  const int rooms = std::max(2, rows * cols / (2 * max_room * max_room));
  if (rows * cols <= kMostCellsJoinedAsDrawn) {
    Cell before = dig_room(map, max_room, rng);
    for (int i = 1; i < rooms; ++i) {
      const Cell room = dig_room(map, max_room, rng);
      dig_corridor(map, before, room, rng);
      before = room;
    }
    return map;
  }
  std::vector<Cell> centres;
  centres.reserve(static_cast<std::size_t>(rooms));
  for (int i = 0; i < rooms; ++i) centres.push_back(dig_room(map, max_room, rng));
  sort_by_strips(centres, 2 * max_room);
  for (std::size_t i = 1; i < centres.size(); ++i) dig_corridor(map, centres[i - 1], centres[i], rng);
  return map;
}

}  // namespace graphdrl
