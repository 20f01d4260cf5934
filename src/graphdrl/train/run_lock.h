// Keeps a run to one trainer at a time.
#pragma once

#include <atomic>
#include <chrono>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file_lock.h"
#include "graphdrl/train/run_directory.h"

namespace graphdrl {

// Another trainer is at work on the run.
class RunLocked : public Busy {
 public:
  using Busy::Busy;
};

// run.lock, held while this lives. On one host the kernel lets go of it with the process. A trainer on another host,
// whose lock may not be seen here, is known by the time of the file, which beat() renews: it is taken for dead after
// kDeadAfter.
class RunLock {
 public:
  static constexpr std::chrono::seconds kDeadAfter{60};

  // Throws RunLocked, and Error where the file cannot be made.
  explicit RunLock(const RunDirectory& run);
  RunLock(const RunLock&) = delete;
  ~RunLock();

  // Throws RunLocked where another trainer took the lock for that of a dead one. Call it before each save.
  void require_held() const;
  // Says that the trainer lives; cheap. Call it every few seconds, on any thread.
  void beat();

 private:
  std::filesystem::path path_;
  Descriptor file_;
  std::atomic<std::chrono::steady_clock::rep> next_beat_ = 0;
};

// Removes the locks in a folder and in those below it that no process of this host holds.
void break_locks(const std::filesystem::path& folder);

}  // namespace graphdrl
