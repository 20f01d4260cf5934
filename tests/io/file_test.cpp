#include "graphdrl/io/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <thread>

#include "graphdrl/io/file_system.h"
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

// Fails one call, with one error.
class Failing final : public FileSystem {
 public:
  Failing(int call, int error_number) : left_(call), error_number_(error_number) { set_file_system(this); }
  ~Failing() override { set_file_system(nullptr); }

  bool has_failed() const { return left_ < 0; }

  int open(const char* path, int flags, mode_t mode) override {
    return fails() ? -1 : FileSystem::open(path, flags, mode);
  }
  ssize_t write(int descriptor, const void* data, std::size_t size) override {
    if (!fails()) return FileSystem::write(descriptor, data, size);
    return FileSystem::write(descriptor, data, size / 2) < 0 ? -1 : (errno = error_number_, -1);
  }
  int fsync(int descriptor) override { return fails() ? -1 : FileSystem::fsync(descriptor); }
  int rename(const char* from, const char* to) override { return fails() ? -1 : FileSystem::rename(from, to); }
  int mkdir(const char* path, mode_t mode) override { return fails() ? -1 : FileSystem::mkdir(path, mode); }

 private:
  bool fails() {
    errno = error_number_;
    return left_-- == 0;
  }

  int left_;
  int error_number_;
};

// Whatever call fails: the old content or the new one, no other file, and an error that blames the machine.
TEST(WriteFile, IsWholeWhateverCallFails) {
  const TemporaryFolder folder;
  for (const int error_number : {ENOSPC, EIO, EROFS}) {
    bool failed = true;
    for (int call = 0; failed; ++call) {
      write_file(folder / "file", "old");
      {
        const Failing failing(call, error_number);
        bool refused = false;
        try {
          write_file(folder / "file", "new content");
        } catch (const MachineError&) {
          refused = true;
        }
        failed = failing.has_failed();
        EXPECT_EQ(refused, failed) << call;
      }
      const std::string content = read_file(folder / "file");
      EXPECT_TRUE(content == "new content" || (failed && content == "old")) << call;
      EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << call;
    }
  }
}

TEST(PrepareFolder, SaysWhateverCallFails) {
  const TemporaryFolder folder;
  bool failed = true;
  for (int call = 0; failed; ++call) {
    const Failing failing(call, ENOSPC);
    const std::string error = error_of([&] { prepare_folder(folder / std::to_string(call) / "a/b"); });
    failed = failing.has_failed();
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
