#include "graphdrl/io/file_check.h"

#include <gtest/gtest.h>

#include "graphdrl/io/file.h"
#include "support.h"

namespace graphdrl {
namespace {

TEST(CheckWritable, LeavesWhatIsThereAndAddsNothing) {
  const TemporaryFolder folder;
  write_file(folder / "old", "content");
  check_writable(folder / "old");
  check_writable(folder / "new");
  EXPECT_EQ(read_file(folder / "old"), "content");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(CheckWritable, RefusesWhatWriteFileWould) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  std::filesystem::create_symlink(folder / "missing/file", folder / "dangling");
  std::filesystem::create_symlink(folder / "circle", folder / "circle");
  for (const std::filesystem::path& path :
       {folder.path(), folder / "", folder / "missing/file", folder / "file/inside", folder / "dangling",
        folder / "circle", folder / std::string(300, 'n'), std::filesystem::path("/dev/null"),
        std::filesystem::path("/proc/self/new")}) {
    EXPECT_NE(error_of([&] { check_writable(path); }), "") << path;
  }
}

TEST(CheckWritable, FollowsLinks) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("later", folder / "link");
  check_writable(folder / "link");
  EXPECT_FALSE(std::filesystem::exists(folder / "later"));
}

}  // namespace
}  // namespace graphdrl
