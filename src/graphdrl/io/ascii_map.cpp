#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {

GridMap parse_ascii_map(std::string_view text, const std::string& source) {
  std::vector<std::string_view> rows;
  for (Lines lines(text); lines.next();) rows.push_back(lines.line());
  while (!rows.empty() && rows.back().empty()) rows.pop_back();
  if (rows.empty()) throw Error({.what = "the map has no rows", .where = source});
  const std::size_t cols = rows.front().size();
  if (rows.size() * std::max<std::size_t>(cols, 1) > std::numeric_limits<NodeId>::max()) {
    throw Error({.what = "the map has too many cells for 32-bit node ids", .where = source});
  }
  GridMap map{.rows = static_cast<int>(rows.size()), .cols = static_cast<int>(cols), .blocked = {}};
  map.blocked.reserve(std::min(rows.size() * cols, text.size()));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t col = 0; col < rows[row].size(); ++col) {
      const char c = rows[row][col];
      if (c != '.' && c != '#') {
        throw Error({.what = "strange character in the map",
                     .expected = "'.' (free) or '#' (blocked)",
                     .got = in_quotes({&c, 1}),
                     .where = fmt::format("{}:{}:{}", source, row + 1, col + 1)});
      }
      map.blocked.push_back(c == '#');
    }
    if (rows[row].size() != cols) {
      throw Error({.what = "rows of unequal length",
                   .expected = fmt::format("{} cells, as in the first row", cols),
                   .got = fmt::format("{}", rows[row].size()),
                   .where = fmt::format("{}:{}", source, row + 1)});
    }
  }
  if (std::find(map.blocked.begin(), map.blocked.end(), false) == map.blocked.end()) {
    throw Error(
        {.what = "the map has no valid node", .expected = "at least one '.'", .got = "only '#'", .where = source});
  }
  return map;
}

std::string format_ascii_map(const GridMap& map) {
  std::string text;
  text.reserve(map.blocked.size() + static_cast<std::size_t>(map.rows));
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) text += map.blocked[map.node({row, col})] ? '#' : '.';
    text += '\n';
  }
  return text;
}

}  // namespace graphdrl
