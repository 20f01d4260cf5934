#include "graphdrl/io/file_check.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

[[noreturn]] void refuse_to_write(const std::filesystem::path& path, int error_number) {
  fail_file(path, "cannot write the file", error_number);
}

}  // namespace

void check_writable(const std::filesystem::path& given) {
  struct stat there {};
  const bool found = stat(given.c_str(), &there) == 0;
  if (!found && errno != ENOENT) refuse_to_write(given, errno);
  if (found && !S_ISREG(there.st_mode)) {
    throw Error({.what = "cannot write the file: something else stands there", .where = given.string()});
  }
  const std::filesystem::path path = end_of_links(given);
  if (!path.has_filename()) refuse_to_write(given, EISDIR);
  const std::filesystem::path folder = folder_of(path);
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse_to_write(given, errno);
  // A file without a name, which goes when it is closed. Some file systems have none.
  const int probe = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (probe >= 0) close(probe);
  if (probe < 0 && errno != EOPNOTSUPP && errno != EISDIR) refuse_to_write(given, errno);
}

}  // namespace graphdrl
