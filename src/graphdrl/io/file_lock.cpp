#include "graphdrl/io/file_lock.h"

#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>

#include "graphdrl/io/file_system.h"

namespace graphdrl {

Descriptor::~Descriptor() {
  if (value_ >= 0) file_system().close(value_);
}

bool is_of(const Descriptor& file, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(file.value(), &opened) == 0 && lstat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

bool try_lock(const Descriptor& file, const std::filesystem::path& path) {
  if (flock(file.value(), LOCK_EX | LOCK_NB) != 0) return false;
  if (is_of(file, path)) return true;
  errno = ENOENT;  // who held it before has removed it
  return false;
}

}  // namespace graphdrl
