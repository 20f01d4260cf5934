#include "graphdrl/io/file_check.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

// What the machine refuses; other errors a caller can mend, by another path or by rights.
bool machine_refuses(int error_number) {
  for (const int one : {ENOSPC, EDQUOT, EFBIG, EIO, EROFS, ENOMEM, EMFILE, ENFILE}) {
    if (error_number == one) return true;
  }
  return false;
}

std::filesystem::path parent_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

[[noreturn]] void refuse_to_write(const std::filesystem::path& path, int error_number) {
  const ErrorParts parts{.what = std::string("cannot write the file (") + std::strerror(error_number) + ")",
                         .where = path.string()};
  if (machine_refuses(error_number)) throw MachineError(parts);
  throw Error(parts);
}

}  // namespace

void check_writable(const std::filesystem::path& given) {
  struct stat there {};
  const bool found = stat(given.c_str(), &there) == 0;
  if (!found && errno != ENOENT) refuse_to_write(given, errno);
  if (found && !S_ISREG(there.st_mode)) {
    throw Error({.what = "cannot write the file: something else stands there", .where = given.string()});
  }
  std::filesystem::path path = given;
  std::error_code ignored;
  while (std::filesystem::is_symlink(path, ignored)) {  // a link is followed; those in a circle were refused above
    path = parent_of(path) / std::filesystem::read_symlink(path, ignored);
  }
  if (!path.has_filename()) refuse_to_write(given, EISDIR);
  const std::filesystem::path folder = parent_of(path);
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse_to_write(given, errno);
  // A file without a name, which goes when it is closed. Some file systems have none.
  const int probe = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (probe >= 0) close(probe);
  if (probe < 0 && errno != EOPNOTSUPP && errno != EISDIR) refuse_to_write(given, errno);
}

}  // namespace graphdrl
