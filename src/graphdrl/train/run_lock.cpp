#include "graphdrl/train/run_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "graphdrl/io/file.h"
#include "graphdrl/io/file_system.h"

namespace graphdrl {
namespace {

using Steady = std::chrono::steady_clock;

constexpr std::chrono::seconds kBeatEvery{10};

std::string host_name() {
  char name[256] = "localhost";
  gethostname(name, sizeof name - 1);
  return name;
}

std::string read_start(const Descriptor& file) {
  char text[512];
  const ssize_t size = pread(file.value(), text, sizeof text, 0);
  return {text, static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
}

// Seconds since the file was last written to or beaten, by the clock of the file system.
double age_of(const Descriptor& file) {
  struct stat before {};
  struct stat now {};
  fstat(file.value(), &before);
  futimens(file.value(), nullptr);
  fstat(file.value(), &now);
  const timespec times[2] = {before.st_atim, before.st_mtim};
  futimens(file.value(), times);
  return static_cast<double>(now.st_mtim.tv_sec - before.st_mtim.tv_sec);
}

[[noreturn]] void refuse(const std::filesystem::path& path, std::string holder, const std::string& expected) {
  if (holder.ends_with('\n')) holder.pop_back();
  throw RunLocked({.what = "another training is at work on this run: " + (holder.empty() ? "unknown" : holder),
                   .expected = expected,
                   .where = path.parent_path().string()});
}

}  // namespace

RunLock::RunLock(const RunDirectory& run) : path_(run.lock()) {
  const std::string host = " on " + host_name() + '\n';
  const std::string own = fmt::format("process {}{}", getpid(), host);
  while (true) {
    file_ = Descriptor(file_system().open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW, 0666));
    if (!file_) fail_file(path_, "cannot lock the run", errno);
    const bool locked = try_lock(file_, path_);
    if (!locked && errno == ENOENT) continue;  // its holder has just ended
    const std::string holder = read_start(file_);
    if (!locked && errno == EWOULDBLOCK) refuse(path_, holder, "to wait for it");
    // A text without its end is of a trainer that was killed as it wrote it.
    const bool is_free = !holder.ends_with('\n') || holder == own || (locked && holder.ends_with(host));
    if (!is_free && age_of(file_) < static_cast<double>(kDeadAfter.count())) {
      refuse(path_, holder, fmt::format("to wait {} s for a sign of life, or --break-lock", kDeadAfter.count()));
    }
    break;
  }
  if (file_system().ftruncate(file_.value(), 0) != 0) fail_file(path_, "cannot lock the run", errno);
  if (const int error_number = write_all(file_.value(), own)) fail_file(path_, "cannot lock the run", error_number);
}

RunLock::~RunLock() {
  if (is_of(file_, path_)) file_system().unlink(path_.c_str());
}

void RunLock::require_held() const {
  if (!is_of(file_, path_)) refuse(path_, "it took over while this one was silent", "one training a run");
}

void RunLock::beat() {
  const auto now = Steady::now().time_since_epoch().count();
  auto due = next_beat_.load(std::memory_order_relaxed);
  if (now < due) return;
  if (next_beat_.compare_exchange_strong(due, now + Steady::duration(kBeatEvery).count())) {
    futimens(file_.value(), nullptr);
  }
}

void break_locks(const std::filesystem::path& folder) {
  std::error_code error;
  const auto break_one = [](const std::filesystem::path& path) {
    const Descriptor file(file_system().open(path.c_str(), O_RDWR | O_NOFOLLOW, 0));
    if (file && try_lock(file, path)) file_system().unlink(path.c_str());
  };
  const std::filesystem::path name = RunDirectory("").lock();
  for (std::filesystem::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename() == name) break_one(entry->path());
  }
}

}  // namespace graphdrl
