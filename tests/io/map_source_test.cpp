#include "graphdrl/io/map_source.h"

#include <gmock/gmock.h>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names(const std::vector<NamedMap>& maps) {
  std::vector<std::string> result;
  for (const NamedMap& map : maps) result.push_back(map.name);
  return result;
}

TEST(MapSource, HoldsThePapersTenMaps) {
  std::vector<int> valid;
  for (const NamedMap& named : load_maps("paper")) {
    const auto& map = std::get<GridMap>(named.map);
    EXPECT_EQ(map.rows, 5);
    EXPECT_EQ(map.cols, 5);
    valid.push_back(World(named.name, map).valid_count());
  }
  EXPECT_THAT(valid, ElementsAre(19, 18, 18, 18, 19, 18, 17, 21, 20, 22));
  EXPECT_EQ(format_ascii_map(std::get<GridMap>(load_map("paper:a").map)), "...#.\n.###.\n.#...\n.#...\n.....\n");
}

TEST(MapSource, ReadsFilesAndFolders) {
  const TemporaryFolder folder;
  write_file(folder / "two.txt", "..\n");
  write_file(folder / "one.map", ".\n");
  write_file(folder / ".hidden", "nonsense");
  EXPECT_THAT(names(load_maps(folder.path().string())), ElementsAre("one", "two"));
  EXPECT_THAT(names(load_maps((folder / "two.txt").string())), ElementsAre("two"));
}

TEST(MapSource, SkipsAByteOrderMark) {
  const TemporaryFolder folder;
  write_file(folder / "table.csv",
             "\xEF\xBB\xBF"
             "from,to\na,b\n");
  const NamedMap named = load_map((folder / "table.csv").string());
  EXPECT_THAT(std::get<GraphMap>(named.map).labels, ElementsAre("a", "b"));
}

TEST(MapSource, RefusesWhatIsNotThere) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([] { load_maps("paper:k"); }), HasSubstr("expected paper:a to paper:j, got 'paper:k'"));
  EXPECT_THAT(error_of([] { load_maps("paper:"); }), HasSubstr("no such map"));
  EXPECT_THAT(error_of([] { load_maps("nowhere.txt"); }), HasSubstr("no such map"));
  EXPECT_THAT(error_of([&] { load_maps(folder.path().string()); }), HasSubstr("no map files"));
  EXPECT_THAT(error_of([] { load_map("paper"); }), HasSubstr("expected one map, got 10"));
}

}  // namespace
}  // namespace graphdrl
