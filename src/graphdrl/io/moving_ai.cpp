#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::string_view kFreeCells = ".GSE";
constexpr std::string_view kBlockedCells = "@OTW";

// Reads the header, to the line `map`.
GridMap parse_header(Lines& lines, const std::string& source) {
  GridMap map;
  const auto fail = [&](const std::string& what, const std::string& expected, std::string_view got) {
    throw Error({.what = what, .expected = expected, .got = in_quotes(got), .where = lines.place()});
  };
  while (lines.next()) {
    const std::string_view line = trimmed(lines.line());
    std::string_view value = line;
    const std::string_view key = take_word(value);
    if (key == "map" && value.empty()) return map;
    if (key == "type") {
      if (value != "octile") fail("a map of another type", "octile", value);
    } else if (key == "height" || key == "width") {
      int& size = key == "height" ? map.rows : map.cols;
      if (size != 0) fail("given twice", "one " + std::string(key), line);
      const auto number = parse_whole(value, 1, std::numeric_limits<NodeId>::max());
      if (!number) fail("bad " + std::string(key), "a whole number from 1 up", value);
      size = static_cast<int>(*number);
    } else {
      fail("strange line in the header", "type, height, width or map", line);
    }
  }
  throw Error({.what = "the file ends within the header", .expected = "a line `map`", .where = source});
}

}  // namespace

bool is_moving_ai(std::string_view text) {
  Lines lines(text);
  return lines.next() && trimmed(lines.line()).starts_with("type ");
}

GridMap parse_moving_ai(std::string_view text, const std::string& source) {
  Lines lines(text, source);
  GridMap map = parse_header(lines, source);
  if (map.rows == 0 || map.cols == 0) {
    throw Error({.what = fmt::format("no {} in the header", map.rows == 0 ? "height" : "width"), .where = source});
  }
  const std::int64_t cells = std::int64_t{map.rows} * map.cols;
  if (cells > std::numeric_limits<NodeId>::max()) {
    throw Error({.what = "the map has too many cells for 32-bit node ids", .where = source});
  }
  // Never more than the text can fill.
  map.blocked.reserve(std::min(static_cast<std::size_t>(cells), text.size()));
  for (int row = 0; row < map.rows; ++row) {
    if (!lines.next()) {
      throw Error({.what = "the file ends within the map",
                   .expected = fmt::format("{} rows", map.rows),
                   .got = std::to_string(row),
                   .where = source});
    }
    const std::string_view line = lines.line();
    if (line.size() != static_cast<std::size_t>(map.cols)) {
      throw Error({.what = "a row of another length",
                   .expected = fmt::format("{} cells, as the header says", map.cols),
                   .got = std::to_string(line.size()),
                   .where = lines.place()});
    }
    for (const char& c : line) {
      const bool blocked = kBlockedCells.find(c) != std::string_view::npos;
      if (!blocked && kFreeCells.find(c) == std::string_view::npos) {
        throw Error({.what = "strange character in the map",
                     .expected = "one of .GSE (free) or @OTW (blocked)",
                     .got = in_quotes({&c, 1}),
                     .where = fmt::format("{}:{}", lines.place(), &c - line.data() + 1)});
      }
      map.blocked.push_back(blocked);
    }
  }
  while (lines.next()) {
    if (trimmed(lines.line()).empty()) continue;
    throw Error(
        {.what = "more rows than the header says", .expected = std::to_string(map.rows), .where = lines.place()});
  }
  if (std::find(map.blocked.begin(), map.blocked.end(), false) == map.blocked.end()) {
    throw Error({.what = "the map has no free cell", .where = source});
  }
  return map;
}

std::string format_moving_ai(const GridMap& map) {
  std::string text = fmt::format("type octile\nheight {}\nwidth {}\nmap\n", map.rows, map.cols);
  for (NodeId node = 0; node < map.rows * map.cols; ++node) {
    text += map.blocked[node] ? '@' : '.';
    if ((node + 1) % map.cols == 0) text += '\n';
  }
  return text;
}

}  // namespace graphdrl
