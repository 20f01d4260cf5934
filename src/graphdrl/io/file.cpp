#include "graphdrl/io/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what, int error_number) {
  throw Error({.what = what + " (" + std::strerror(error_number) + ")", .where = path.string()});
}

// Closes on destruction; a descriptor of -1 stands for a failed open.
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) close(value);
  }
};

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return fsync(descriptor) == 0;
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) fail(path, "cannot read the file", EISDIR);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(path, "cannot read the file", errno);
  std::string content;
  if (const auto size = std::filesystem::file_size(path, ignored); !ignored) content.reserve(size);
  char block[65'536];
  while (stream.read(block, sizeof block) || stream.gcount() > 0) {
    content.append(block, static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !stream.eof()) fail(path, "cannot read the file", EIO);
  return content;
}

void write_file(const std::filesystem::path& given, std::string_view content) {
  std::error_code error;
  std::filesystem::path path = std::filesystem::canonical(given, error);  // where a link leads
  if (error) path = given;                                                // nothing there yet
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    throw Error({.what = "cannot write the file: something else stands there", .where = path.string()});
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const std::filesystem::path temporary = path.string() + ".tmp" + std::to_string(getpid());
  {
    const Descriptor file{open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
    if (file.value < 0) fail(path, "cannot write the file", errno);
    if (!write_all(file.value, content)) {
      const int error_number = errno;
      unlink(temporary.c_str());
      fail(path, "cannot write the file", error_number);
    }
  }
  if (rename(temporary.c_str(), path.c_str()) != 0) {
    const int error_number = errno;
    unlink(temporary.c_str());
    fail(path, "cannot write the file", error_number);
  }
  const Descriptor parent{open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (parent.value >= 0) fsync(parent.value);  // best effort: not every file system syncs folders
}

void prepare_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) fail(folder, "cannot create the folder", error.value());
  if (access(folder.c_str(), W_OK | X_OK) != 0) fail(folder, "cannot write into the folder", errno);
}

}  // namespace graphdrl
