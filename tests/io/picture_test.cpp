#include "graphdrl/io/picture.h"

#include <gmock/gmock.h>

#include "graphdrl/io/readers.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Raster parsed(const std::string& bytes) {
  return read_picture(bytes, "file");
}

TEST(Picture, ReadsEveryKindOfNetpbm) {
  const std::vector<std::string> pictures = {
      "P1\n# white, black\n2 2\n0 1\n10",
      "P2\n2 2 4 4 0 0 4",
      "P3\n2 2\n# x\n9\n9 9 9  0 0 0  0 0 0  9 9 9\n",
      std::string("P4\n2 2\n") + '\x40' + '\x80',
      std::string("P5\n2 2\n255\n") + '\xff' + '\0' + '\0' + '\xff',
      std::string("P5 2 2 255\n") + '\xff' + '\0' + '\0' + '\xff',
      std::string("P5\n2 2\n65535\n") + "\xff\xff" + std::string(4, '\0') + "\xff\xff",
      std::string("P6\n2 2\n255\n") + std::string(3, '\xff') + std::string(6, '\0') + std::string(3, '\xff'),
  };
  for (const std::string& bytes : pictures) {
    const Raster picture = parsed(bytes);
    EXPECT_EQ(picture.width, 2);
    EXPECT_EQ(picture.height, 2);
    ASSERT_EQ(std::ssize(picture.samples), 4 * picture.channels);
    for (int i = 0; i < 4 * picture.channels; ++i) {
      EXPECT_EQ(picture.samples[i], i / picture.channels % 3 == 0 ? 255 : 0) << bytes;
    }
  }
}

TEST(Picture, RefusesWhatIsDamaged) {
  const auto complaint = [](const std::string& bytes) { return error_of([&] { parsed(bytes); }); };
  EXPECT_THAT(complaint("GIF89a"), HasSubstr("not a picture: expected PNG, PGM, PBM or PPM"));
  EXPECT_THAT(complaint("P5\n"), HasSubstr("not a number"));
  EXPECT_THAT(complaint("P5\n2 -2 255\n"), HasSubstr("not a number"));
  EXPECT_THAT(complaint("P5\n100000 100000 255\n"), HasSubstr("too many pixels"));
  EXPECT_THAT(complaint("P5\n10000 10000 255\nabc"), HasSubstr("the file ends within the picture"));
  EXPECT_THAT(complaint("P5\n2 2 0\nabcd"), HasSubstr("a maximum of 0"));
  EXPECT_THAT(complaint("P5\n0 2 255\nabcd"), HasSubstr("too many pixels: expected 1 to"));
  EXPECT_THAT(complaint("P2\n2 1 255 0 x"), HasSubstr("not a number"));
  EXPECT_THAT(complaint("P2\n2 1 255 0 256"), HasSubstr("a whole number up to 255"));
  EXPECT_THAT(complaint("P1\n2 1 0 2"), HasSubstr("not a bit"));
  EXPECT_THAT(complaint("\x89PNG\r\n\x1a\nnothing"), HasSubstr("a PNG file that cannot be read"));
  const std::string png = format_png_map({.rows = 9, .cols = 9, .blocked = std::vector<bool>(81)});
  EXPECT_THAT(complaint(png.substr(0, png.size() / 2)), HasSubstr("a PNG file that cannot be read"));
  std::string huge = png;  // 10^5 by 10^5, as its header says
  for (const int at : {16, 20}) huge.replace(at, 4, std::string("\x00\x01\x86\xa0", 4));
  EXPECT_NE(complaint(huge), "");
}

TEST(Picture, RefusesMoreCellsThanItsBytesMayHold) {
  const auto blank = [](int side) {
    return format_png_map({.rows = side, .cols = side, .blocked = std::vector<bool>(std::size_t(side) * side)});
  };
  EXPECT_EQ(parse_png_map(blank(4000), "file").cols, 4000);
  const std::string larger = blank(5000);
  EXPECT_LT(larger.size(), 100'000U);
  const std::string complaint = error_of([&] { parse_png_map(larger, "file"); });
  EXPECT_THAT(complaint, HasSubstr("more cells than a file of this size may hold: expected at most 16777216"));
  EXPECT_THAT(complaint, HasSubstr("--cell-pixels"));
  EXPECT_EQ(parse_png_map(larger, "file", {.cell_pixels = 2}).cols, 2500);
  EXPECT_NE(error_of([&] { read_picture(larger, "file"); }), "");
  EXPECT_EQ(read_picture(larger, "file", 1.5).width, 5000);
  std::string vast = larger;  // 14,000 by 14,000, as its header says
  for (const int at : {16, 20}) vast.replace(at, 4, std::string("\x00\x00\x36\xb0", 4));
  EXPECT_NE(error_of([&] { parse_png_map(vast, "file", {.cell_pixels = 100}); }), "");
}

TEST(Picture, BecomesAGrid) {
  const std::string bytes = "P2\n5 4 255\n255 255 127 255 0\n255 255 255 255 0\n128 255 0 0 0\n255 255 0 0 0\n";
  const GridMap pixels = parse_netpbm_map(bytes, "file");
  EXPECT_EQ(pixels.rows, 4);
  EXPECT_EQ(pixels.cols, 5);
  EXPECT_TRUE(pixels.blocked[2]);
  EXPECT_FALSE(pixels.blocked[10]);
  const GridMap cells = parse_netpbm_map(bytes, "file", {.cell_pixels = 2});
  EXPECT_EQ(cells.rows, 2);
  EXPECT_EQ(cells.cols, 2);
  EXPECT_THAT(cells.blocked, ElementsAre(false, true, false, true));
  // Yellow and red, as bright as they look.
  const GridMap colours = parse_netpbm_map("P3\n2 1\n255\n255 255 0  255 0 0\n", "file");
  EXPECT_THAT(colours.blocked, ElementsAre(false, true));
  EXPECT_THAT(error_of([&] { parse_netpbm_map(bytes, "file", {.cell_pixels = 5}); }), HasSubstr("smaller than a cell"));
  EXPECT_THAT(error_of([&] { parse_netpbm_map("P2\n1 1 255 0", "file"); }), HasSubstr("no free cell"));
}

}  // namespace
}  // namespace graphdrl
