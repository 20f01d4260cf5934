#include "graphdrl/io/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <thread>

#include "failing_disk.h"
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

TEST(WriteFile, WritesWhereADanglingLinkLeads) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  std::filesystem::create_symlink("there/file", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "there/file"), "new");
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_NE(error_of([&] { write_file(folder / "loop", "new"); }), "");
}

TEST(WriteFile, KeepsTheModeOfWhatItReplaces) {
  const TemporaryFolder folder;
  const auto mode_of = [&](const char* name) { return std::filesystem::status(folder / name).permissions(); };
  const mode_t mask = umask(027);
  write_file(folder / "new", "");
  umask(mask);
  EXPECT_EQ(mode_of("new"), std::filesystem::perms(0640));
  std::filesystem::permissions(folder / "new", std::filesystem::perms(0600));
  write_file(folder / "new", "other");
  EXPECT_EQ(mode_of("new"), std::filesystem::perms(0600));
}

TEST(WriteFile, TakesTheLongestNames) {
  const TemporaryFolder folder;
  const std::string longest(255, 'n');
  write_file(folder / longest, "content");
  EXPECT_EQ(read_file(folder / longest), "content");
}

// What a killed writer leaves goes; a living one's stays, and so does what only looks like it.
TEST(WriteFile, RemovesWhatDeadWritersLeft) {
  const TemporaryFolder folder;
  const auto plant = [&](const char* name) {
    return Descriptor(open((folder / name).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  };
  { plant(".graphdrl.0123456789abcdef.tmp"); }
  { plant(".graphdrl.notes"); }
  const Descriptor alive = plant(".graphdrl.fedcba9876543210.tmp");
  ASSERT_TRUE(try_lock(alive, folder / ".graphdrl.fedcba9876543210.tmp"));
  write_file(folder / "file", "");
  EXPECT_FALSE(std::filesystem::exists(folder / ".graphdrl.0123456789abcdef.tmp"));
  EXPECT_TRUE(std::filesystem::exists(folder / ".graphdrl.fedcba9876543210.tmp"));
  EXPECT_TRUE(std::filesystem::exists(folder / ".graphdrl.notes"));
}

// Eight threads write one file, and others read it: each reader sees a whole content of one of them.
TEST(WriteFileThread, ManyWritersOfOneFileDoNotMeet) {
  const TemporaryFolder folder;
  constexpr int kWriters = 8;
  constexpr int kWrites = 20;
  write_file(folder / "file", std::string(100'000, 'a'));
  std::atomic<int> failed = 0;
  std::atomic<bool> done = false;
  std::vector<std::thread> threads;
  for (int writer = 0; writer < kWriters; ++writer) {
    threads.emplace_back([&, content = std::string(100'000, static_cast<char>('a' + writer))] {
      for (int i = 0; i < kWrites; ++i)
        failed += error_of([&] { write_file(folder / "file", content); }).empty() ? 0 : 1;
    });
  }
  std::thread reader([&] {
    while (!done) {
      const std::string content = read_file(folder / "file");
      if (content.size() != 100'000 || content.find_first_not_of(content[0]) != std::string::npos) ++failed;
    }
  });
  for (std::thread& thread : threads) thread.join();
  done = true;
  reader.join();
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteFileAndKeep, KeepsWhatWasThere) {
  const TemporaryFolder folder;
  write_file_and_keep(folder / "a", "1", folder / "before");
  EXPECT_FALSE(std::filesystem::exists(folder / "before"));
  write_file_and_keep(folder / "a", "2", folder / "before");
  write_file_and_keep(folder / "a", "3", folder / "before");
  EXPECT_EQ(read_file(folder / "a"), "3");
  EXPECT_EQ(read_file(folder / "before"), "2");
}

// Whatever call fails: the old content or the new one, no other file, and an error that blames the machine.
TEST(WriteFile, IsWholeWhateverCallFails) {
  const TemporaryFolder folder;
  for (const int error_number : {ENOSPC, EIO, EROFS}) {
    bool failed = true;
    for (int call = 0; failed; ++call) {
      write_file(folder / "file", "old");
      {
        const FailingDisk disk(call, error_number);
        bool refused = false;
        try {
          write_file(folder / "file", "new content");
        } catch (const MachineError&) {
          refused = true;
        }
        failed = disk.has_failed();
        EXPECT_EQ(refused, failed) << call;
      }
      const std::string content = read_file(folder / "file");
      EXPECT_TRUE(content == "new content" || (failed && content == "old")) << call;
      EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << call;
    }
  }
}

TEST(AppendedFile, TakesBackATextThatFails) {
  const TemporaryFolder folder;
  AppendedFile file(folder / "file");
  file.append("first\n");
  {
    const FailingDisk disk(0, ENOSPC);
    EXPECT_THROW(file.append("second\n"), MachineError);
  }
  EXPECT_EQ(read_file(folder / "file"), "first\n");
  {
    const FailingDisk disk(0, ENOSPC, /*all_later=*/true);  // it is not taken back
    EXPECT_THROW(file.append("second\n"), MachineError);
  }
  EXPECT_EQ(read_file(folder / "file"), "first\nsec");
}

TEST(PrepareFolder, SaysWhateverCallFails) {
  const TemporaryFolder folder;
  bool failed = true;
  for (int call = 0; failed; ++call) {
    const FailingDisk disk(call, ENOSPC);
    const std::string error = error_of([&] { prepare_folder(folder / std::to_string(call) / "a/b"); });
    failed = disk.has_failed();
    EXPECT_EQ(!error.empty(), failed) << call;
  }
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
