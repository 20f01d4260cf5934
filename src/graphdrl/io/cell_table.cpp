#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

// Adds the cells of a line, and gives how many they are; nothing where it has anything else. parted: whether something
// stands between the cells, known from the first line.
std::optional<std::size_t> add_cells(std::string_view line, std::optional<bool>& parted, std::vector<bool>& blocked) {
  line = trimmed(line);
  const std::size_t before = blocked.size();
  if (!parted && line.size() > 1) parted = line[1] != '0' && line[1] != '1';
  bool cell_next = true;
  for (const char c : line) {
    if ((c == '0' || c == '1') && cell_next) {
      blocked.push_back(c == '1');
      cell_next = !parted.value_or(true);
    } else if (parted.value_or(true) && (c == ' ' || c == '\t' || ((c == ',' || c == ';') && !cell_next))) {
      cell_next = true;
    } else {
      return std::nullopt;
    }
  }
  return blocked.size() - before;
}

// Two or three numbers a line may be edges and their costs: of two nodes there are two at most, no loop among them.
bool may_be_edges(const GridMap& map) {
  if (map.cols > 3 || map.rows > 2) return false;
  for (int row = 0; row < map.rows; ++row) {
    if (map.blocked[map.node({row, 0})] == map.blocked[map.node({row, 1})]) return false;
  }
  return map.rows == 1 || map.blocked[0] != map.blocked[map.node({1, 0})];
}

// The rows of a text, and the number of the line that is none; 0 where all are.
int read_rows(std::string_view text, GridMap& map) {
  std::optional<bool> parted;
  for (Lines lines(text); lines.next();) {
    const auto cells = add_cells(lines.line(), parted, map.blocked);
    if (cells && *cells == 0) continue;
    if (map.rows++ == 0) map.cols = static_cast<int>(cells.value_or(0));
    if (!cells || static_cast<int>(*cells) != map.cols) return lines.number();
  }
  return 0;
}

}  // namespace

bool is_cell_table(std::string_view text) {
  GridMap map{.rows = 0, .cols = 0, .blocked = {}};
  return text.size() <= std::numeric_limits<NodeId>::max() && read_rows(text, map) == 0 && map.cols >= 2 &&
         !may_be_edges(map);
}

GridMap parse_cell_table(std::string_view text, const std::string& source, const MapOptions& options) {
  GridMap map{.rows = 0, .cols = 0, .blocked = {}};
  if (const int line = read_rows(text, map); line != 0 || map.cols < 2) {
    throw Error({.what = "not a row of cells",
                 .expected = "0 and 1, as many as in the first row, and at least two",
                 .where = fmt::format("{}:{}", source, std::max(1, line))});
  }
  if (std::find(map.blocked.begin(), map.blocked.end(), false) == map.blocked.end()) {
    throw Error({.what = "the grid has no free cell", .expected = "a 0", .where = source});
  }
  bool matrix = map.rows == map.cols;  // symmetric, and no node its own neighbour
  for (int row = 0; matrix && row < map.rows; ++row) {
    for (int col = 0; col <= row; ++col) {
      matrix = matrix && map.blocked[map.node({row, col})] == map.blocked[map.node({col, row})] &&
               !(row == col && map.blocked[map.node({row, col})]);
    }
  }
  if (options.note) {
    options.note(fmt::format("{}: taken for a grid of {} rows and {} columns, 1 is blocked{}", source, map.rows,
                             map.cols, matrix ? "; an adjacency matrix is read as a NumPy array" : ""));
  }
  return map;
}

}  // namespace graphdrl
