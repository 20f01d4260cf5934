#include "graphdrl/io/file_system.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace graphdrl {
namespace {

FileSystem* replaced_by = nullptr;

}  // namespace

int FileSystem::open(const char* path, int flags, mode_t mode) {
  return ::open(path, flags | O_CLOEXEC, mode);
}
ssize_t FileSystem::write(int descriptor, const void* data, std::size_t size) {
  return ::write(descriptor, data, size);
}
int FileSystem::ftruncate(int descriptor, off_t size) {
  return ::ftruncate(descriptor, size);
}
int FileSystem::fsync(int descriptor) {
  return ::fsync(descriptor);
}
int FileSystem::close(int descriptor) {
  return ::close(descriptor);
}
int FileSystem::rename(const char* from, const char* to) {
  return std::rename(from, to);
}
int FileSystem::unlink(const char* path) {
  return ::unlink(path);
}
int FileSystem::mkdir(const char* path, mode_t mode) {
  return ::mkdir(path, mode);
}

FileSystem& file_system() {
  static FileSystem machine;
  return replaced_by != nullptr ? *replaced_by : machine;
}

void set_file_system(FileSystem* replacement) {
  replaced_by = replacement;
}

int write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = file_system().write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : EIO;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace graphdrl
