#include "graphdrl/graph/grid_generators.h"

#include <algorithm>
#include <array>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

// The frozen splits join rooms in the order drawn up to this size; the corridors are as long as the map is wide.
constexpr int kMostCellsJoinedAsDrawn = 500 * 500;

struct Rectangle {
  int top;
  int left;
  int height;
  int width;
};

// Calls visit(cell) for the cells of a rectangle, row by row; steps of 2 leave out every other row and column.
template <typename Visit>
void for_each_cell(const Rectangle& cells, const Visit& visit, int step = 1) {
  for (int row = cells.top; row < cells.top + cells.height; row += step) {
    for (int col = cells.left; col < cells.left + cells.width; col += step) visit(Cell{row, col});
  }
}

Rectangle all_of(const GridMap& map) {
  return {0, 0, map.rows, map.cols};
}

void fill(GridMap& map, const Rectangle& cells, bool blocked) {
  for_each_cell(cells, [&](Cell cell) { map.blocked[map.node(cell)] = blocked; });
}

GridMap blocked_map(int rows, int cols) {
  return {.rows = rows, .cols = cols, .blocked = std::vector<bool>(static_cast<std::size_t>(rows) * cols, true)};
}

// Each cell is blocked with a probability.
GridMap noise_map(int rows, int cols, double blocked, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  for (auto cell : map.blocked) cell = rng.uniform() < blocked;
  return map;
}

// A rectangle of a height and a width, anywhere on the map.
Rectangle draw_rectangle(const GridMap& map, int height, int width, Rng& rng) {
  return {rng.index(map.rows - height + 1), rng.index(map.cols - width + 1), height, width};
}

// A random spanning tree of the rooms by depth-first search, the usual maze: long corridors, few short dead ends.
GridMap carved_maze(int rows, int cols, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  std::vector<Cell> trail = {{0, 0}};
  map.blocked[0] = false;
  while (!trail.empty()) {
    const Cell here = trail.back();
    std::array<Cell, kDirectionCount> ways;
    int count = 0;
    for (const Cell& step : map.steps()) {
      const Cell next = here + step + step;
      if (map.contains(next) && !map.is_free(next)) ways[count++] = step;
    }
    if (count == 0) {
      trail.pop_back();
      continue;
    }
    const Cell step = ways[rng.index(count)];
    trail.push_back(here + step + step);
    map.blocked[map.node(here + step)] = map.blocked[map.node(trail.back())] = false;
  }
  return map;
}

// Whether a cell beside a room is a wall with another room behind it.
bool parts_rooms(const GridMap& map, Cell cell) {
  if (!map.contains(cell) || map.is_free(cell)) return false;
  return cell.row % 2 == 0 ? cell.col + 1 < map.cols : cell.row + 1 < map.rows;
}

// Draws a rectangle of 2 to max_room cells a side, frees its cells and gives the middle one.
Cell dig_room(GridMap& map, int max_room, Rng& rng) {
  const int height = std::min(map.rows, 2 + rng.index(max_room - 1));
  const int width = std::min(map.cols, 2 + rng.index(max_room - 1));
  const Rectangle room = draw_rectangle(map, height, width, rng);
  fill(map, room, false);
  return {room.top + height / 2, room.left + width / 2};
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

// Splits a rectangle in two along its longer side, and leaves a strip of some cells between them: gives the strip, and
// what is on either side of it. REQUIRES: the longer side has at least thickness + 2 cells.
std::array<Rectangle, 3> split(const Rectangle& whole, int thickness, Rng& rng) {
  const bool across = whole.height > whole.width || (whole.height == whole.width && rng.below(2) == 0);
  const int length = across ? whole.height : whole.width;
  const int before = 1 + rng.index(length - thickness - 1);
  const auto part = [&](int from, int size) {
    return across ? Rectangle{whole.top + from, whole.left, size, whole.width}
                  : Rectangle{whole.top, whole.left + from, whole.height, size};
  };
  return {part(before, thickness), part(0, before), part(before + thickness, length - before - thickness)};
}

// Whether more than half of a cell and those around it are blocked.
bool mostly_blocked(const GridMap& map, Cell cell) {
  int cells = 1;
  int blocked = map.is_free(cell) ? 0 : 1;
  for (const Cell& step : kGridSteps) {
    if (!map.contains(cell + step)) continue;
    ++cells;
    blocked += map.blocked[map.node(cell + step)];
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
  std::vector<Cell> between;  // the two parts
  for_each_cell(wall, [&](Cell cell) {
    const Cell step = across ? Cell{1, 0} : Cell{0, 1};
    const Cell before{cell.row - step.row, cell.col - step.col};
    if (map.is_free(before) && map.is_free(cell + step)) between.push_back(cell);
  });
  const int doors = between.empty() ? 0 : 1 + rng.index(2);
  for (int i = 0; i < doors; ++i) {
    map.blocked[map.node(between[rng.below(static_cast<std::uint32_t>(between.size()))])] = false;
  }
}

// Frees the streets of a rectangle and of its parts; the blocks between them are free where they are squares.
void build_streets(GridMap& map, const Rectangle& whole, int max_street, int max_block, double squares, Rng& rng) {
  const int longer = std::max(whole.height, whole.width);
  if (longer <= max_block || longer < 3) {
    fill(map, whole, !(rng.uniform() < squares));
    return;
  }
  const int width = 1 + rng.index(std::min(max_street, longer - 2));
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
  return largest_component(noise_map(rows, cols, obstacles, rng));
}

GridMap maze_map(int rows, int cols, double loops, Rng& rng) {
  GridMap map = carved_maze(rows, cols, rng);
  const auto open_walls = [&](Cell room) {
    for (const Cell wall : {room + Cell{0, 1}, room + Cell{1, 0}}) {
      if (parts_rooms(map, wall) && rng.uniform() < loops) map.blocked[map.node(wall)] = false;
    }
  };
  for_each_cell(all_of(map), open_walls, 2);
  return map;
}

GridMap braided_maze_map(int rows, int cols, double braid, Rng& rng) {
  GridMap map = carved_maze(rows, cols, rng);
  const auto open_dead_end = [&](Cell room) {
    const auto ways = std::ranges::count_if(map.steps(), [&](const Cell& step) { return map.is_free(room + step); });
    if (ways != 1 || !(rng.uniform() < braid)) return;
    std::array<Cell, kDirectionCount> closed;
    int count = 0;
    for (const Cell wall : {room + Cell{-1, 0}, room + Cell{0, -1}, room + Cell{0, 1}, room + Cell{1, 0}}) {
      if (parts_rooms(map, wall)) closed[count++] = wall;
    }
    if (count > 0) map.blocked[map.node(closed[rng.index(count)])] = false;
  };
  for_each_cell(all_of(map), open_dead_end, 2);
  return map;
}

GridMap rooms_map(int rows, int cols, int max_room, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  const int rooms = std::max(2, rows * cols / (2 * max_room * max_room));
  const bool as_drawn = rows * cols <= kMostCellsJoinedAsDrawn;
  std::vector<Cell> centres;
  for (int i = 0; i < rooms; ++i) {
    centres.push_back(dig_room(map, max_room, rng));
    if (as_drawn && i > 0) dig_corridor(map, centres[i - 1], centres[i], rng);
  }
  if (as_drawn) return map;
  sort_by_strips(centres, 2 * max_room);
  for (int i = 1; i < rooms; ++i) dig_corridor(map, centres[i - 1], centres[i], rng);
  return map;
}

GridMap caves_map(int rows, int cols, double rock, Rng& rng) {
  constexpr int kSmoothings = 4;
  GridMap map = noise_map(rows, cols, rock, rng);
  for (int i = 0; i < kSmoothings; ++i) {
    GridMap smooth = map;
    for_each_cell(all_of(map), [&](Cell cell) { smooth.blocked[map.node(cell)] = mostly_blocked(map, cell); });
    map = std::move(smooth);
  }
  return largest_component(map);
}

GridMap house_map(int rows, int cols, int max_room, double furniture, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  fill(map, all_of(map), false);
  build_walls(map, all_of(map), max_room, rng);
  const auto floor = static_cast<double>(map.free_count());
  double taken = 0;
  for (double tries = floor; tries > 0 && taken < furniture * floor; --tries) {
    const int height = std::min(rows, 1 + rng.index(3));
    const int width = std::min(cols, 1 + rng.index(height == 3 ? 2 : 3));
    const Rectangle piece = draw_rectangle(map, height, width, rng);
    bool fits = true;
    for_each_cell(piece, [&](Cell cell) { fits = fits && map.is_free(cell); });
    if (!fits) continue;
    fill(map, piece, true);
    taken += height * width;
  }
  return largest_component(map);
}

GridMap streets_map(int rows, int cols, int max_street, int max_block, double squares, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  build_streets(map, all_of(map), max_street, max_block, squares, rng);
  return largest_component(map);
}

GridMap room_grid_map(int rows, int cols, int room, double doors, Rng& rng) {
  GridMap map = blocked_map(rows, cols);
  for (int top = 0; top < rows; top += room + 1) {
    for (int left = 0; left < cols; left += room + 1) {
      const int height = std::min(room, rows - top);
      const int width = std::min(room, cols - left);
      fill(map, {top, left, height, width}, false);
      const bool room_on_right = left + room + 1 < cols;
      const bool room_below = top + room + 1 < rows;
      if (room_on_right && rng.uniform() < doors) map.blocked[map.node({top + rng.index(height), left + room})] = false;
      if (room_below && rng.uniform() < doors) map.blocked[map.node({top + room, left + rng.index(width)})] = false;
    }
  }
  return largest_component(map);
}

}  // namespace graphdrl
