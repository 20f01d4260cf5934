#include "graphdrl/io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <mutex>
#include <random>
#include <set>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file_system.h"

namespace graphdrl {
namespace {

constexpr std::string_view kTemporaryBegin = ".graphdrl.";
constexpr std::string_view kTemporaryEnd = ".tmp";
constexpr int kMostLinks = 40;  // that lead to one another, as in Linux

bool is_of_machine(int error_number) {
  for (const int one : {ENOSPC, EDQUOT, EFBIG, EIO, EROFS, ENOMEM, EMFILE, ENFILE, ENOLCK}) {
    if (error_number == one) return true;
  }
  return false;
}

int sync_folder(const std::filesystem::path& folder) {
  const Descriptor descriptor(file_system().open(folder.c_str(), O_RDONLY | O_DIRECTORY, 0));
  if (!descriptor) return errno == EACCES ? 0 : errno;  // a folder to write into, not to read
  if (file_system().fsync(descriptor.value()) == 0) return 0;
  return errno == EINVAL || errno == ENOTSUP ? 0 : errno;  // not every file system syncs folders
}

bool is_temporary(const std::string& name) {
  return name.starts_with(kTemporaryBegin) && name.ends_with(kTemporaryEnd);
}

// Removes the temporary files of dead writers; a living one holds the lock of its own. Once for each folder: a folder
// may have many files.
void remove_leftovers(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> done;
  const std::lock_guard lock(mutex);
  std::error_code error;
  if (!done.insert(std::filesystem::absolute(folder, error)).second) return;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!is_temporary(entry->path().filename().string())) continue;
    const Descriptor file(::open(entry->path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file && try_lock(file, entry->path())) file_system().unlink(entry->path().c_str());
  }
}

// A new file of a random name beside another, with its mode, removed unless it is moved.
class Temporary {
 public:
  explicit Temporary(const std::filesystem::path& beside) : target_(beside) {
    struct stat old {};
    const bool replaces = stat(beside.c_str(), &old) == 0;
    std::random_device random;
    do {
      path_ = folder_of(beside) / fmt::format("{}{:08x}{:08x}{}", kTemporaryBegin, random(), random(), kTemporaryEnd);
      // Nobody else may read it before it has its mode.
      const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW;
      file_ = Descriptor(file_system().open(path_.c_str(), flags, replaces ? 0600 : 0666));
      if (!file_ && errno != EEXIST) fail_now(errno);
    } while (!file_ || (!try_lock(file_, path_) && (errno == EWOULDBLOCK || errno == ENOENT)));
    if (replaces) {
      // Only root may give a file away.
      if (old.st_uid != geteuid() || old.st_gid != getegid()) {
        [[maybe_unused]] const int refused = fchown(file_.value(), old.st_uid, old.st_gid);
      }
      if (fchmod(file_.value(), old.st_mode & 07777) != 0) fail_now(errno);
    }
  }
  Temporary(const Temporary&) = delete;
  ~Temporary() {
    if (!gone_) file_system().unlink(path_.c_str());
  }

  void write(std::string_view content) {
    if (const int error_number = write_all(file_.value(), content)) fail_now(error_number);
    if (file_system().fsync(file_.value()) != 0) fail_now(errno);
  }

  void move_to_target() {
    if (file_system().rename(path_.c_str(), target_.c_str()) != 0) fail_now(errno);
    gone_ = true;
    if (const int error_number = sync_folder(folder_of(target_))) fail_now(error_number);
  }

 private:
  [[noreturn]] void fail_now(int error_number) {
    if (file_ && !gone_) file_system().unlink(path_.c_str());
    gone_ = true;
    fail_file(target_, "cannot write the file", error_number);
  }

  std::filesystem::path target_;
  std::filesystem::path path_;
  Descriptor file_;
  bool gone_ = false;
};

void write_file(const std::filesystem::path& given, std::string_view content, const std::filesystem::path* previous) {
  const std::filesystem::path path = end_of_links(given);
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    throw Error({.what = "cannot write the file: something else stands there", .where = path.string()});
  }
  remove_leftovers(folder_of(path));
  Temporary file(path);
  file.write(content);
  if (previous != nullptr && file_system().rename(path.c_str(), previous->c_str()) != 0 && errno != ENOENT) {
    fail_file(*previous, "cannot write the file", errno);
  }
  file.move_to_target();
}

}  // namespace

void fail_file(const std::filesystem::path& path, const std::string& what, int error_number) {
  const ErrorParts parts{.what = what + " (" + std::strerror(error_number) + ")", .where = path.string()};
  if (is_of_machine(error_number)) throw MachineError(parts);
  throw Error(parts);
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

std::filesystem::path end_of_links(std::filesystem::path path) {
  std::error_code error;
  for (int links = 0; std::filesystem::is_symlink(path, error); ++links) {
    if (links == kMostLinks) fail_file(path, "cannot write the file", ELOOP);
    const std::filesystem::path target = std::filesystem::read_symlink(path, error);
    if (error) fail_file(path, "cannot write the file", error.value());
    path = folder_of(path) / target;
  }
  return path;
}

std::string read_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) fail_file(path, "cannot read the file", EISDIR);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail_file(path, "cannot read the file", errno);
  std::string content;
  if (const auto size = std::filesystem::file_size(path, ignored); !ignored) content.reserve(size);
  char block[65'536];
  while (stream.read(block, sizeof block) || stream.gcount() > 0) {
    content.append(block, static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !stream.eof()) fail_file(path, "cannot read the file", EIO);
  return content;
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  write_file(path, content, nullptr);
}

void write_file_and_keep(const std::filesystem::path& path, std::string_view content,
                         const std::filesystem::path& previous) {
  write_file(path, content, &previous);
}

void prepare_folder(const std::filesystem::path& folder) {
  std::filesystem::path part;
  for (const std::filesystem::path& name : folder) {
    const std::filesystem::path parent = part.empty() ? "." : part;
    part /= name;
    std::error_code error;
    if (name.empty() || std::filesystem::is_directory(part, error)) continue;
    if (file_system().mkdir(part.c_str(), 0777) != 0 && errno != EEXIST) {
      fail_file(folder, "cannot create the folder", errno);
    }
    if (!std::filesystem::is_directory(part, error)) fail_file(folder, "cannot create the folder", ENOTDIR);
    if (const int error_number = sync_folder(parent)) fail_file(folder, "cannot create the folder", error_number);
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) fail_file(folder, "cannot write into the folder", errno);
}

AppendedFile::AppendedFile(const std::filesystem::path& path)
    : AppendedFile(path, Descriptor(file_system().open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666))) {}

std::optional<AppendedFile> AppendedFile::create(const std::filesystem::path& path) {
  const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_APPEND;
  Descriptor file(file_system().open(path.c_str(), flags, 0666));
  if (!file && errno == EEXIST) return std::nullopt;
  return AppendedFile(path, std::move(file));
}

AppendedFile::AppendedFile(std::filesystem::path path, Descriptor file)
    : path_(std::move(path)), file_(std::move(file)) {
  struct stat now {};
  if (!file_ || fstat(file_.value(), &now) != 0) fail_file(path_, "cannot write the file", errno);
  size_ = now.st_size;
}

void AppendedFile::append(std::string_view text) {
  if (const int error_number = write_all(file_.value(), text)) {
    [[maybe_unused]] const int ignored = file_system().ftruncate(file_.value(), size_);
    fail_file(path_, "cannot write the file", error_number);
  }
  size_ += std::ssize(text);
}

void AppendedFile::sync() {
  if (file_system().fsync(file_.value()) != 0) fail_file(path_, "cannot write the file", errno);
}

}  // namespace graphdrl
