// A double of the file layer for tests of what is said where the disk refuses.
#pragma once

#include <cerrno>

#include "graphdrl/io/file_system.h"

namespace graphdrl {

// In the place of the machine's file layer while it lives. One call fails, counted from 0, and all later ones on
// demand. A write that fails writes half.
class FailingDisk final : public FileSystem {
 public:
  FailingDisk(int call, int error_number, bool all_later = false)
      : left_(call), error_number_(error_number), all_later_(all_later) {
    set_file_system(this);
  }
  ~FailingDisk() override { set_file_system(nullptr); }

  bool has_failed() const { return left_ < 0; }

  int open(const char* path, int flags, mode_t mode) override {
    return fails() ? -1 : FileSystem::open(path, flags, mode);
  }
  ssize_t write(int descriptor, const void* data, std::size_t size) override {
    if (!fails()) return FileSystem::write(descriptor, data, size);
    return FileSystem::write(descriptor, data, size / 2) < 0 ? -1 : (errno = error_number_, -1);
  }
  int ftruncate(int descriptor, off_t size) override { return fails() ? -1 : FileSystem::ftruncate(descriptor, size); }
  int fsync(int descriptor) override { return fails() ? -1 : FileSystem::fsync(descriptor); }
  int rename(const char* from, const char* to) override { return fails() ? -1 : FileSystem::rename(from, to); }
  int mkdir(const char* path, mode_t mode) override { return fails() ? -1 : FileSystem::mkdir(path, mode); }

 private:
  bool fails() {
    errno = error_number_;
    const int left = left_--;
    return left == 0 || (left < 0 && all_later_);
  }

  int left_;
  int error_number_;
  bool all_later_;
};

}  // namespace graphdrl
