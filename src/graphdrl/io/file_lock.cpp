#include "graphdrl/io/file_lock.h"

#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>

#include "graphdrl/io/file_system.h"

namespace graphdrl {

Descriptor::~Descriptor() {
  if (value_ >= 0) file_system().close(value_);
}

bool try_lock(const Descriptor& file, const std::filesystem::path& path) {
  if (flock(file.value(), LOCK_EX | LOCK_NB) != 0) return false;
  // Who held it before may have removed it: then errno says so too.
  errno = ENOENT;
  struct stat held {};
  struct stat named {};
  return fstat(file.value(), &held) == 0 && lstat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

}  // namespace graphdrl
