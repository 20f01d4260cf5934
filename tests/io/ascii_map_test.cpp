#include "graphdrl/io/readers.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

std::string error_for(std::string_view text) {
  return error_of([&] { parse_ascii_map(text, "m.txt"); });
}

TEST(AsciiMap, RoundTrips) {
  const std::string text = "..#\n#..\n";
  const GridMap map = parse_ascii_map(text, "m.txt");
  EXPECT_EQ(map.rows, 2);
  EXPECT_EQ(map.cols, 3);
  EXPECT_EQ(map.blocked, (std::vector<bool>{false, false, true, true, false, false}));
  EXPECT_EQ(format_ascii_map(map), text);
}

TEST(AsciiMap, TakesOtherLineEndsAndEmptyLinesAtTheEnd) {
  EXPECT_EQ(format_ascii_map(parse_ascii_map("..\r\n#.\r\n\r\n\n", "m.txt")), "..\n#.\n");
  EXPECT_EQ(format_ascii_map(parse_ascii_map(".", "m.txt")), ".\n");
}

TEST(AsciiMap, SaysWhereItIsWrong) {
  EXPECT_EQ(error_for("...\n.x.\n"),
            "m.txt:2:2: strange character in the map: expected '.' (free) or '#' (blocked), got 'x'");
  EXPECT_EQ(error_for("...\n..\n"), "m.txt:2: rows of unequal length: expected 3 cells, as in the first row, got 2");
  EXPECT_EQ(error_for("...\n\n...\n"), "m.txt:2: rows of unequal length: expected 3 cells, as in the first row, got 0");
  EXPECT_EQ(error_for("##\n##\n"), "m.txt: the map has no valid node: expected at least one '.', got only '#'");
  EXPECT_EQ(error_for(""), "m.txt: the map has no rows");
  EXPECT_EQ(error_for("\n\n"), "m.txt: the map has no rows");
  EXPECT_NE(error_for(std::string_view("..\0.", 4)), "");
}

TEST(AsciiMap, AnyBytesGiveAMapOrAnError) {
  Rng rng(3);
  const std::string_view alphabet = "..##\n\r\x01\xffx";
  for (int i = 0; i < 20'000; ++i) {
    std::string text;
    for (std::uint32_t n = rng.below(20); n > 0; --n) {
      text += alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))];
    }
    try {
      const GridMap map = parse_ascii_map(text, "fuzz");
      EXPECT_EQ(map.blocked.size(), static_cast<std::size_t>(map.rows) * map.cols);
      EXPECT_EQ(format_ascii_map(parse_ascii_map(format_ascii_map(map), "again")), format_ascii_map(map));
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace graphdrl
