// Files that one process at a time holds. The kernel lets go of them when the process ends, whatever ends it
// [flock(2)].
#pragma once

#include <filesystem>
#include <utility>

namespace graphdrl {

// A file descriptor, closed at the end; -1 for none.
class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  ~Descriptor();

  int value() const { return value_; }
  explicit operator bool() const { return value_ >= 0; }

 private:
  int value_;
};

// Whether an open file is the one that `path` names.
bool is_of(const Descriptor& file, const std::filesystem::path& path);

// Locks an open file. Gives false with errno EWOULDBLOCK where another descriptor holds it, with ENOENT where the file
// is no longer what `path` names, and with another where the file system has no locks.
bool try_lock(const Descriptor& file, const std::filesystem::path& path);

}  // namespace graphdrl
