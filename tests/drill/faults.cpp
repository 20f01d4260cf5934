// For LD_PRELOAD: counts the calls of a program, of all its threads, that change files, and makes one of them fail, or
// ends the program there. The environment says what to do:
//   GRAPHDRL_FAULTS_BELOW  FOLDER: only calls on what lies below it (default: all but /dev, /proc and /sys)
//   GRAPHDRL_FAULTS_LOG    FILE: append a line "NAME PATH" for each call, before it is made
//   GRAPHDRL_FAULTS_AT     N: the call to act at, counted from 1
//   GRAPHDRL_FAULTS_DO     kill-before, kill-half (of what a write writes) or kill-after: ends the program by SIGKILL;
//                          ENOSPC, EIO or EROFS: the call fails; half-ENOSPC …: a write writes half, the next call
//                          fails
//   GRAPHDRL_FAULTS_ON     1: all later calls fail too
// Counts neither standard output and error nor pipes. Catches C++ streams: libstdc++ calls open, write and writev for
// them. Does not catch what libc writes for fwrite and its like, which the programs use for standard output alone.
#undef _FORTIFY_SOURCE  // its inline functions have the names that are defined here

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

int error_number_of(std::string_view name) {
  if (name == "ENOSPC") return ENOSPC;
  if (name == "EIO") return EIO;
  if (name == "EROFS") return EROFS;
  return 0;
}

std::string resolved(const std::string& path) {
  char real[PATH_MAX];
  return realpath(path.c_str(), real) == nullptr ? path : real;
}

struct Orders {
  std::string below = resolved(variable("GRAPHDRL_FAULTS_BELOW"));
  long at = std::atol(variable("GRAPHDRL_FAULTS_AT").c_str());
  std::string what = variable("GRAPHDRL_FAULTS_DO");
  bool on = variable("GRAPHDRL_FAULTS_ON") == "1";
  bool cut = what.starts_with("cut-");
  bool kill = cut || what.starts_with("kill-");
  bool half = what.starts_with("half-") || what.ends_with("-half");
  int error_number = error_number_of(std::string_view(what).substr(half ? 5 : 0));
  int log = -1;

  Orders() {
    const std::string file = variable("GRAPHDRL_FAULTS_LOG");
    // Not by open(), which is caught.
    if (!file.empty()) {
      log = static_cast<int>(
          syscall(SYS_openat, AT_FDCWD, file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
    }
  }
};

const Orders& orders() {
  static const Orders read;
  return read;
}

std::atomic<long> calls = 0;

// The path, or nothing where calls on it do not count.
std::string counted(const std::string& path) {
  if (!path.starts_with('/')) return "";  // a pipe, a socket
  for (const char* const exempt : {"/dev/", "/proc/", "/sys/"}) {
    if (path.starts_with(exempt)) return "";
  }
  const std::string& below = orders().below;
  if (below.empty() || path == below || path.starts_with(below + '/')) return path;
  return "";
}

std::string path_of(int descriptor) {
  char path[PATH_MAX];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t length = readlink(link.c_str(), path, sizeof path);
  return length < 0 ? "" : std::string(path, static_cast<std::size_t>(length));
}

std::string counted(int descriptor) {
  if (descriptor == STDOUT_FILENO || descriptor == STDERR_FILENO) return "";
  return counted(path_of(descriptor));
}

// Of a name in a folder; AT_FDCWD is the current one.
std::string counted(int folder, const char* name) {
  std::string path = name;
  if (!path.starts_with('/')) path = (folder == AT_FDCWD ? resolved(".") : path_of(folder)) + '/' + path;
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  const std::size_t slash = path.rfind('/');
  return counted(resolved(path.substr(0, slash + 1)) + '/' + path.substr(slash + 1));
}

// Files that hold bytes that no sync has followed.
class Unsynced {
 public:
  // Before bytes are added.
  void written(int descriptor) {
    struct stat now {};
    if (!orders().cut || fstat(descriptor, &now) != 0) return;
    const std::lock_guard lock(mutex_);
    const auto [file, is_new] = files_.try_emplace(now.st_ino);
    if (is_new) file->second = {dup(descriptor), now.st_size};
  }
  void synced(int descriptor) {
    struct stat now {};
    if (!orders().cut || fstat(descriptor, &now) != 0) return;
    const std::lock_guard lock(mutex_);
    const auto file = files_.find(now.st_ino);
    if (file == files_.end()) return;
    close(file->second.descriptor);
    files_.erase(file);
  }
  // Takes the bytes away, and lets nobody go on.
  void lose() {
    mutex_.lock();
    for (const auto& [inode, file] : files_) syscall(SYS_ftruncate, file.descriptor, file.synced_size);
  }

 private:
  struct File {
    int descriptor;  // of its own: the program may close the file
    off_t synced_size;
  };
  std::mutex mutex_;
  std::map<ino_t, File> files_;
};

Unsynced& unsynced() {
  static auto* const files = new Unsynced;  // never destroyed: threads may write until the end
  return *files;
}

enum class Fate { kDone, kHalfDone, kFails };

struct Turn {
  Fate fate = Fate::kDone;
  bool dies = false;  // after the call
};

void die() {
  if (orders().cut) unsynced().lose();
  kill(getpid(), SIGKILL);
}

// Counts a call, and says what becomes of it. May end the program.
Turn take_turn(const char* name, const std::string& path, bool is_write = false) {
  if (path.empty()) return {};
  const Orders& order = orders();
  const long number = ++calls;
  if (order.log >= 0) {
    const std::string line = name + (' ' + path) + '\n';
    syscall(SYS_write, order.log, line.data(), line.size());
  }
  if (order.at == 0 || number < order.at) return {};
  if (number == order.at) {
    const Fate fate = order.half && is_write ? Fate::kHalfDone : Fate::kDone;
    if (order.kill && order.what.ends_with("-before")) die();
    if (order.kill) return {.fate = fate, .dies = true};
    if (order.half) return {.fate = fate};
  }
  if (order.error_number == 0 || (!order.on && number > order.at + (order.half ? 1 : 0))) return {};
  errno = order.error_number;
  return {.fate = Fate::kFails};
}

template <typename Call>
auto in_turn(const char* name, const std::string& path, Call call) -> decltype(call()) {
  const Turn turn = take_turn(name, path);
  if (turn.fate == Fate::kFails) {
    if constexpr (std::is_pointer_v<decltype(call())>) return nullptr;
    return decltype(call())(-1);
  }
  const auto result = call();
  if (turn.dies) die();
  return result;
}

// call(size) writes that much.
template <typename Call>
ssize_t write_in_turn(const char* name, int descriptor, std::size_t size, Call call) {
  const Turn turn = take_turn(name, counted(descriptor), /*is_write=*/true);
  if (turn.fate == Fate::kFails) return -1;
  unsynced().written(descriptor);
  const ssize_t result = call(turn.fate == Fate::kHalfDone ? (size + 1) / 2 : size);
  if (turn.dies) die();
  return result;
}

std::vector<iovec> cut(const iovec* parts, int count, std::size_t size) {
  std::vector<iovec> kept;
  for (int i = 0; i < count && size > 0; ++i) {
    kept.push_back({parts[i].iov_base, std::min(size, parts[i].iov_len)});
    size -= kept.back().iov_len;
  }
  return kept;
}

std::size_t size_of(const iovec* parts, int count) {
  std::size_t size = 0;
  for (int i = 0; i < count; ++i) size += parts[i].iov_len;
  return size;
}

bool changes(int flags) {
  return (flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC)) != 0;
}

bool changes(const char* mode) {
  return std::string_view(mode).find_first_of("wa+") != std::string_view::npos;
}

}  // namespace

// The function of libc that a function here stands before.
#define NEXT(name) (reinterpret_cast<decltype(&::name)>(dlsym(RTLD_NEXT, #name)))

// The mode is given only where a file may be created.
#define READ_MODE(flags, mode)                                      \
  mode_t mode = 0;                                                  \
  if (((flags)&O_CREAT) != 0 || ((flags)&O_TMPFILE) == O_TMPFILE) { \
    va_list rest;                                                   \
    va_start(rest, flags);                                          \
    (mode) = va_arg(rest, mode_t);                                  \
    va_end(rest);                                                   \
  }

#define OPEN(name)                                                           \
  int name(const char* path, int flags, ...) {                               \
    READ_MODE(flags, mode)                                                   \
    static const auto next = NEXT(name);                                     \
    const std::string which = changes(flags) ? counted(AT_FDCWD, path) : ""; \
    return in_turn("open", which, [&] { return next(path, flags, mode); });  \
  }

#define OPENAT(name)                                                                \
  int name(int folder, const char* path, int flags, ...) {                          \
    READ_MODE(flags, mode)                                                          \
    static const auto next = NEXT(name);                                            \
    const std::string which = changes(flags) ? counted(folder, path) : "";          \
    return in_turn("open", which, [&] { return next(folder, path, flags, mode); }); \
  }

#define FOPEN(name)                                                         \
  FILE* name(const char* path, const char* mode) {                          \
    static const auto next = NEXT(name);                                    \
    const std::string which = changes(mode) ? counted(AT_FDCWD, path) : ""; \
    return in_turn("open", which, [&] { return next(path, mode); });        \
  }

#define CREAT(name)                                                                    \
  int name(const char* path, mode_t mode) {                                            \
    static const auto next = NEXT(name);                                               \
    return in_turn("open", counted(AT_FDCWD, path), [&] { return next(path, mode); }); \
  }

#define MKSTEMP(name)                                                            \
  int name(char* path) {                                                         \
    static const auto next = NEXT(name);                                         \
    return in_turn("open", counted(AT_FDCWD, path), [&] { return next(path); }); \
  }

#define MKOSTEMP(name)                                                                  \
  int name(char* path, int flags) {                                                     \
    static const auto next = NEXT(name);                                                \
    return in_turn("open", counted(AT_FDCWD, path), [&] { return next(path, flags); }); \
  }

#define PWRITE(name, Offset)                                                                  \
  ssize_t name(int descriptor, const void* data, std::size_t size, Offset at) {               \
    static const auto next = NEXT(name);                                                      \
    return write_in_turn("write", descriptor, size,                                           \
                         [&](std::size_t some) { return next(descriptor, data, some, at); }); \
  }

#define TRUNCATE(name, Offset)                                                               \
  int name(int descriptor, Offset size) noexcept {                                           \
    static const auto next = NEXT(name);                                                     \
    return in_turn("truncate", counted(descriptor), [&] { return next(descriptor, size); }); \
  }

#define SYNC(name)                                    \
  int name(int descriptor) {                          \
    static const auto next = NEXT(name);              \
    return in_turn("sync", counted(descriptor), [&] { \
      const int result = next(descriptor);            \
      if (result == 0) unsynced().synced(descriptor); \
      return result;                                  \
    });                                               \
  }

#define UNLINK(name)                                                               \
  int name(const char* path) noexcept {                                            \
    static const auto next = NEXT(name);                                           \
    return in_turn("unlink", counted(AT_FDCWD, path), [&] { return next(path); }); \
  }

extern "C" {

OPEN(open)
OPEN(open64)
OPENAT(openat)
OPENAT(openat64)
FOPEN(fopen)
FOPEN(fopen64)
CREAT(creat)
CREAT(creat64)
MKSTEMP(mkstemp)
MKSTEMP(mkstemp64)
MKOSTEMP(mkostemp)
MKOSTEMP(mkostemp64)

ssize_t write(int descriptor, const void* data, std::size_t size) {
  static const auto next = NEXT(write);
  return write_in_turn("write", descriptor, size, [&](std::size_t some) { return next(descriptor, data, some); });
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  static const auto next = NEXT(writev);
  return write_in_turn("write", descriptor, size_of(parts, count), [&](std::size_t some) {
    const std::vector<iovec> kept = cut(parts, count, some);
    return next(descriptor, kept.data(), static_cast<int>(kept.size()));
  });
}

PWRITE(pwrite, off_t)
PWRITE(pwrite64, off64_t)
TRUNCATE(ftruncate, off_t)
TRUNCATE(ftruncate64, off64_t)
SYNC(fsync)
SYNC(fdatasync)

int rename(const char* from, const char* to) noexcept {
  static const auto next = NEXT(rename);
  return in_turn("rename", counted(AT_FDCWD, to), [&] { return next(from, to); });
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  static const auto next = NEXT(renameat);
  return in_turn("rename", counted(to_folder, to), [&] { return next(from_folder, from, to_folder, to); });
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  static const auto next = NEXT(renameat2);
  return in_turn("rename", counted(to_folder, to), [&] { return next(from_folder, from, to_folder, to, flags); });
}

int link(const char* from, const char* to) noexcept {
  static const auto next = NEXT(link);
  return in_turn("link", counted(AT_FDCWD, to), [&] { return next(from, to); });
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  static const auto next = NEXT(linkat);
  return in_turn("link", counted(to_folder, to), [&] { return next(from_folder, from, to_folder, to, flags); });
}

UNLINK(unlink)
UNLINK(rmdir)
UNLINK(remove)

int unlinkat(int folder, const char* path, int flags) noexcept {
  static const auto next = NEXT(unlinkat);
  return in_turn("unlink", counted(folder, path), [&] { return next(folder, path, flags); });
}

int mkdir(const char* path, mode_t mode) noexcept {
  static const auto next = NEXT(mkdir);
  return in_turn("mkdir", counted(AT_FDCWD, path), [&] { return next(path, mode); });
}

int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  static const auto next = NEXT(mkdirat);
  return in_turn("mkdir", counted(folder, path), [&] { return next(folder, path, mode); });
}

int fchmod(int descriptor, mode_t mode) noexcept {
  static const auto next = NEXT(fchmod);
  return in_turn("chmod", counted(descriptor), [&] { return next(descriptor, mode); });
}

}  // extern "C"
