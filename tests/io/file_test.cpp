#include "graphdrl/io/file.h"

#include <gtest/gtest.h>

#include "support.h"

namespace graphdrl {
namespace {

TEST(WriteFile, ReplacesTheFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  write_file(folder / "a", "old");
  write_file(folder / "a", "new");
  EXPECT_EQ(read_file(folder / "a"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteFile, KeepsTheOldFileWhenItFails) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "taken");
  write_file(folder / "taken/inside", "old");
  EXPECT_NE(error_of([&] { write_file(folder / "taken", "new"); }), "");  // a folder stands there
  EXPECT_EQ(read_file(folder / "taken/inside"), "old");
  EXPECT_NE(error_of([&] { write_file(folder / "missing/a", "new"); }), "");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteFile, FollowsALinkAndLeavesSpecialFilesAlone) {
  const TemporaryFolder folder;
  write_file(folder / "file", "old");
  std::filesystem::create_symlink(folder / "file", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "file"), "new");
  EXPECT_NE(error_of([] { write_file("/dev/null", "text"); }), "");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(ReadFile, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_NE(error_of([&] { read_file(folder.path()); }), "");
  EXPECT_NE(error_of([&] { read_file(folder / "missing"); }), "");
}

TEST(PrepareFolder, SaysWhyItCannot) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  EXPECT_NE(error_of([&] { prepare_folder(folder / "file/run"); }), "");
  prepare_folder(folder / "a/b");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b"));
}

}  // namespace
}  // namespace graphdrl
