#include "graphdrl/io/readers.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <png.h>

#include "graphdrl/io/file.h"
#include "graphdrl/io/map_source.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kHead = "resolution: 0.5\norigin: [-1.0, 2.0, 0.0]\n";

class RosMap : public ::testing::Test {
 protected:
  // Shades: free, unknown, blocked, free.
  void SetUp() override { write_file(folder_ / "a.pgm", "P2\n2 2 255\n254 205 0 255\n"); }

  GridMap read(const std::string& yaml, const MapOptions& options = {}) {
    const std::filesystem::path path = folder_ / "a.yaml";
    write_file(path, yaml);
    return std::get<GridMap>(load_map(path.string(), options).map);
  }

  TemporaryFolder folder_;
};

TEST_F(RosMap, HasAFrameAndThreeKindsOfCells) {
  const std::string yaml =
      std::string("image: a.pgm\n") + kHead + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  const GridMap map = read(yaml);
  EXPECT_THAT(map.blocked, ElementsAre(false, true, true, false));
  ASSERT_TRUE(map.frame);
  EXPECT_EQ(map.frame->unit, "m");
  EXPECT_EQ(map.place(0), (Point{-0.75, 2.75}));
  EXPECT_EQ(map.place(3), (Point{-0.25, 2.25}));
  EXPECT_THAT(read(yaml, {.unknown_is_free = true}).blocked, ElementsAre(false, false, true, false));
  EXPECT_THAT(read("image: a.pgm\nnegate: 1\n" + std::string(kHead)).blocked, ElementsAre(true, true, false, true));
  const GridMap turned = read("image: a.pgm\nresolution: 1\norigin: [0, 0, 1.5707963267948966]\n");
  EXPECT_NEAR(turned.place(0).x, -1.5, 1e-12);
  EXPECT_NEAR(turned.place(0).y, 0.5, 1e-12);
}

TEST_F(RosMap, RawModeHoldsOccupancy) {
  write_file(folder_ / "a.pgm", "P2\n2 2 255\n0 50 100 255\n");
  const std::string yaml = std::string("image: a.pgm\nmode: raw\n") + kHead;
  EXPECT_THAT(read(yaml).blocked, ElementsAre(false, true, true, true));
  EXPECT_THAT(read(yaml, {.unknown_is_free = true}).blocked, ElementsAre(false, false, true, false));
}

// As map_server and nav2 do: means of red, green and blue, no luminance; alpha is a fourth in trinary mode only.
TEST_F(RosMap, CountsColoursByTheirMean) {
  // Green and yellow look bright, and are dark by their mean; light grey; white.
  write_file(folder_ / "a.pgm", "P3\n4 1 255\n0 255 0  255 255 0  230 230 230  255 255 255\n");
  const std::string yaml = std::string("image: a.pgm\noccupied_thresh: 0.65\nfree_thresh: 0.196\n") + kHead;
  EXPECT_THAT(read(yaml).blocked, ElementsAre(true, true, false, false));
  EXPECT_THAT(read(yaml, {.unknown_is_free = true}).blocked, ElementsAre(true, false, false, false));
}

TEST_F(RosMap, TakesWhatIsTransparentForUnknown) {
  // Grey and alpha: white, black and black, white; the second and the last are transparent, or nearly opaque.
  const auto write = [&](char alpha) {
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    image.width = 4;
    image.height = 1;
    image.format = PNG_FORMAT_GA;
    const std::string samples{'\xff', '\xff', 0, alpha, 0, '\xff', '\xff', alpha};
    std::string bytes(1000, '\0');
    png_alloc_size_t size = bytes.size();
    ASSERT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, samples.data(), 0, nullptr), 0);
    write_file(folder_ / "a.png", bytes.substr(0, size));
  };
  const auto blocked = [&](const std::string& mode, bool unknown_is_free) {
    return read("image: a.png\nmode: " + mode + "\n" + kHead, {.unknown_is_free = unknown_is_free}).blocked;
  };
  write(0);
  EXPECT_THAT(blocked("scale", false), ElementsAre(false, true, true, true));
  EXPECT_THAT(blocked("scale", true), ElementsAre(false, false, true, false));
  EXPECT_THAT(blocked("Trinary", false), ElementsAre(false, true, true, true));
  EXPECT_THAT(blocked("trinary", true), ElementsAre(false, true, true, false)) << "means 0, 63.75 and 191.25";
  write('\xfe');
  EXPECT_THAT(blocked("scale", false), ElementsAre(false, true, true, true)) << "not opaque";
  EXPECT_THAT(blocked("trinary", false), ElementsAre(false, true, true, false));
}

// Recognition asks the YAML parser.
TEST_F(RosMap, IsYamlHoweverItIsWritten) {
  for (const char* const yaml :
       {"image : a.pgm\nresolution : 0.5\n", "\"image\": a.pgm\n'resolution': 0.5\nnegate: False\n",
        "{\"image\": \"a.pgm\", \"resolution\": 0.5, \"negate\": 0}\n",
        "---\n# by hand\nresolution: 0.5\nimage: a.pgm\n...\n",
        "? image\n: a.pgm\n? resolution\n: 0.5\nnegate: off\n"}) {
    EXPECT_THAT(read(yaml).blocked, ElementsAre(false, true, true, false)) << yaml;
  }
  EXPECT_THAT(read("image: a.pgm\nresolution: 0.5\nnegate: TRUE\n").blocked, ElementsAre(true, true, false, true));
}

TEST_F(RosMap, TakesThePictureBesideItForThatOfAnotherMachine) {
  std::string note;
  const MapOptions options{.note = [&](const std::string& text) { note = text; }};
  for (const char* const path : {"/home/me/maps/a.pgm", "'C:\\maps\\a.pgm'"}) {
    note = "";
    EXPECT_THAT(read(fmt::format("image: {}\n{}", path, kHead), options).blocked,
                ElementsAre(false, true, true, false));
    EXPECT_THAT(note, HasSubstr("a.pgm beside it is read, not")) << path;
  }
  note = "";
  read(fmt::format("image: {}\n{}", (folder_ / "a.pgm").string(), kHead), options);
  EXPECT_EQ(note, "") << "its own machine";
}

TEST_F(RosMap, ReadsNothingButItsPicture) {
  const auto complaint = [&](const std::string& yaml) { return error_of([&] { read(yaml); }); };
  for (const char* const image : {"/etc/hostname", "../a.pgm", "b/../../a.pgm", "\"\""}) {
    EXPECT_THAT(complaint(std::string("image: ") + image + "\n" + kHead), HasSubstr("a.yaml:1: ")) << image;
  }
  std::filesystem::create_symlink("/etc/hostname", folder_ / "link.pgm");
  EXPECT_THAT(complaint(std::string("image: link.pgm\n") + kHead), HasSubstr("outside of the folder"));
  EXPECT_THAT(complaint(std::string("image: none.pgm\n") + kHead), HasSubstr("none.pgm"));
  EXPECT_THAT(complaint(std::string("image: a.yaml\n") + kHead), HasSubstr("not a picture"));
}

TEST_F(RosMap, RefusesBadValues) {
  const auto complaint = [&](const std::string& rest) { return error_of([&] { read("image: a.pgm\n" + rest); }); };
  EXPECT_THAT(complaint("resolution: 0\n"), HasSubstr("a.yaml:2: bad resolution: expected a number"));
  EXPECT_THAT(complaint("resolution: .nan\n"), HasSubstr("bad resolution"));
  EXPECT_THAT(complaint("resolution: 1\norigin: [1]\n"), HasSubstr("a.yaml:3: bad origin"));
  EXPECT_THAT(complaint("resolution: 1\nnegate: 2\n"), HasSubstr("bad negate"));
  EXPECT_THAT(complaint("resolution: 1\nmode: new\n"), HasSubstr("bad mode: expected trinary, scale or raw"));
  EXPECT_THAT(complaint("resolution: 1\nfree_thresh: 0.7\n"), HasSubstr("free_thresh is above occupied_thresh"));
  EXPECT_THAT(complaint("resolution: [\n"), HasSubstr("YAML that cannot be read"));
  EXPECT_THAT(complaint("resolution: 1\n" + std::string(10'000, '[')), HasSubstr("YAML that cannot be read"));
}

TEST_F(RosMap, LosesWhatLargerCellsAndARobotTake) {
  std::string picture = "P2\n10 6 255\n";
  for (int i = 0; i < 60; ++i) picture += i == 22 ? "0 " : "255 ";
  write_file(folder_ / "a.pgm", picture);
  const std::string yaml = std::string("image: a.pgm\n") + kHead;
  std::string note;
  const MapOptions options{.cell_size = 2.0, .note = [&](const std::string& text) { note = text; }};
  const GridMap map = read(yaml, options);  // from 6 rows and 10 columns, from the lower left corner
  EXPECT_EQ(map.rows, 1);
  EXPECT_EQ(map.cols, 2);
  EXPECT_THAT(map.blocked, ElementsAre(true, false));
  EXPECT_EQ(map.place(1), (Point{2, 3}));
  EXPECT_THAT(note, HasSubstr("10.75 of 14.75 square m of free ground, 72.9 %, became blocked"));
  EXPECT_THAT(error_of([&] { read(yaml, {.cell_size = 0.1}); }), HasSubstr("bad cell size: expected 0.5 to 3 m"));
  EXPECT_THAT(error_of([&] { read(yaml, {.robot_radius = 9}); }), HasSubstr("no cell is left free"));
  const GridMap grown = read(yaml, {.robot_radius = 0.3});
  EXPECT_EQ(std::count(grown.blocked.begin(), grown.blocked.end(), true), 5);
}

TEST_F(RosMap, OptionsThatMeanNothingAreRefused) {
  const auto complaint = [](const std::string& map, const MapOptions& options) {
    return error_of([&] { load_map(map, options); });
  };
  EXPECT_THAT(complaint("paper:a", {.cell_size = 2}), HasSubstr("--cell-size goes with maps that say how large"));
  EXPECT_THAT(complaint("paper:a", {.unknown_is_free = true}), HasSubstr("--unknown goes with ROS maps"));
  EXPECT_THAT(complaint("paper:a", {.cell_pixels = 2}), HasSubstr("--cell-pixels goes with pictures"));
  EXPECT_THAT(complaint("paper:a", {.cost_attribute = "x"}), HasSubstr("--cost-attribute goes with graphs"));
  const std::filesystem::path path = folder_ / "a.dot";
  write_file(path, "graph { a -- b }");
  EXPECT_THAT(complaint(path.string(), {.robot_radius = 1}), HasSubstr("--robot-radius goes with grids"));
  EXPECT_THAT(complaint(path.string(), {.diagonals = true}), HasSubstr("--connectivity goes with grids"));
  std::filesystem::remove(path);
  read(std::string("image: a.pgm\n") + kHead);
  EXPECT_EQ(load_maps(folder_.path().string()).size(), 1u);  // the picture is no map of its own
}

}  // namespace
}  // namespace graphdrl
