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

struct Rectangle {
  int top;
  int left;
  int height;
  int width;
};

// Splits a rectangle in two along its longer side, and leaves a strip of some cells between them: gives the strip, and
// what is on either side of it. REQUIRES: the longer side has at least thickness + 2 cells.
std::array<Rectangle, 3> split(const Rectangle& whole, int thickness, Rng& rng) {
  const bool across = whole.height > whole.width || (whole.height == whole.width && rng.below(2) == 0);
  const int length = across ? whole.height : whole.width;
  const int before = 1 + static_cast<int>(rng.below(static_cast<std::uint32_t>(length - thickness - 1)));
  const auto part = [&](int from, int size) {
    return across ? Rectangle{whole.top + from, whole.left, size, whole.width}
                  : Rectangle{whole.top, whole.left + from, whole.height, size};
  };
  return {part(before, thickness), part(0, before), part(before + thickness, length - before - thickness)};
}

void fill(GridMap& map, const Rectangle& rectangle, bool blocked) {
  for (int row = rectangle.top; row < rectangle.top + rectangle.height; ++row) {
    for (int col = rectangle.left; col < rectangle.left + rectangle.width; ++col) {
      map.blocked[map.node({row, col})] = blocked;
    }
  }
}

// Whether more than half of a cell and those around it are blocked.
bool mostly_blocked(const GridMap& map, Cell cell) {
  int cells = 0;
  int blocked = 0;
  for (int row = std::max(cell.row - 1, 0); row <= std::min(cell.row + 1, map.rows - 1); ++row) {
    for (int col = std::max(cell.col - 1, 0); col <= std::min(cell.col + 1, map.cols - 1); ++col) {
      ++cells;
      blocked += map.blocked[map.node({row, col})];
    }
  }
  return 2 * blocked > cells;
}

// Walls, with doors where they stand between free cells, in a rectangle and in its parts.
void build_walls(GridMap& map, const Rectangle& whole, int max_room, Rng& rng) {
  if (std::max(whole.height, whole.width) <= std::max(max_room, 2)) return;
  const auto [wall, one, other] = split(whole, 1, rng);
  build_walls(map, one, max_room, rng);
  build_walls(map, other, max_room, rng);
  fill(map, wall, true);
  const bool across = one.top != wall.top;
  std::vector<Cell> places;
  for (int row = wall.top; row < wall.top + wall.height; ++row) {
    for (int col = wall.left; col < wall.left + wall.width; ++col) {
      const Cell before = across ? Cell{row - 1, col} : Cell{row, col - 1};
      const Cell after = across ? Cell{row + 1, col} : Cell{row, col + 1};
      if (!map.blocked[map.node(before)] && !map.blocked[map.node(after)]) places.push_back({row, col});
    }
  }
  const std::uint32_t doors = places.empty() ? 0 : 1 + rng.below(2);
  for (std::uint32_t i = 0; i < doors; ++i) {
    map.blocked[map.node(places[rng.below(static_cast<std::uint32_t>(places.size()))])] = false;
  }
}

// Frees the streets of a rectangle and of its parts; the blocks between them are free where they are squares.
void build_streets(GridMap& map, const Rectangle& whole, int max_street, int max_block, double squares, Rng& rng) {
  const int longer = std::max(whole.height, whole.width);
  if (longer <= max_block || longer < 3) {
    fill(map, whole, !(rng.uniform() < squares));
    return;
  }
  const int width = 1 + static_cast<int>(rng.below(static_cast<std::uint32_t>(std::min(max_street, longer - 2))));
  const auto [street, one, other] = split(whole, width, rng);
  fill(map, street, false);
  build_streets(map, one, max_street, max_block, squares, rng);
  build_streets(map, other, max_street, max_block, squares, rng);
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

GridMap caves_map(int rows, int cols, double rock, Rng& rng) {
  constexpr int kSmoothings = 4;
  GridMap map = blocked_map(rows, cols);
  for (std::size_t i = 0; i < map.blocked.size(); ++i) map.blocked[i] = rng.uniform() < rock;
  for (int i = 0; i < kSmoothings; ++i) {
    GridMap smooth = map;
    for (int row = 0; row < rows; ++row) {
      for (int col = 0; col < cols; ++col) smooth.blocked[map.node({row, col})] = mostly_blocked(map, {row, col});
    }
    map = std::move(smooth);
  }
  return largest_component(map);
}

GridMap house_map(int rows, int cols, int max_room, double furniture, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  fill(map, {0, 0, rows, cols}, false);
  build_walls(map, {0, 0, rows, cols}, max_room, rng);
  const auto floor = static_cast<double>(std::count(map.blocked.begin(), map.blocked.end(), false));
  double taken = 0;
  for (double tries = floor; tries > 0 && taken < furniture * floor; --tries) {
    const auto below = [&](int count) { return static_cast<int>(rng.below(static_cast<std::uint32_t>(count))); };
    const int height = std::min(rows, 1 + below(3));
    const int width = std::min(cols, 1 + below(height == 3 ? 2 : 3));
    const Rectangle piece{below(rows - height + 1), below(cols - width + 1), height, width};
    bool fits = true;
    for (int row = piece.top; row < piece.top + height; ++row) {
      for (int col = piece.left; col < piece.left + width; ++col) fits = fits && !map.blocked[map.node({row, col})];
    }
    if (!fits) continue;
    fill(map, piece, true);
    taken += height * width;
  }
  return largest_component(map);
}

GridMap streets_map(int rows, int cols, int max_street, int max_block, double squares, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  build_streets(map, {0, 0, rows, cols}, max_street, max_block, squares, rng);
  return largest_component(map);
}

}  // namespace graphdrl
