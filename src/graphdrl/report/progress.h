// Progress on standard error: of trainings, plans and evaluations.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace graphdrl {

// A bar that rewrites its line on a terminal; plain lines at intervals elsewhere; nothing if standard error is closed.
class ProgressDisplay {
 public:
  // `unit`: what is counted, such as "episode". `first`: how many were done before this session. Nothing is shown in
  // the first `quiet_s` seconds: for work that is mostly done by then.
  explicit ProgressDisplay(std::string unit, std::int64_t first = 0, double quiet_s = 0);
  ProgressDisplay(const ProgressDisplay&) = delete;
  ~ProgressDisplay() { finish(); }

  // Shows how many are done and the status, unless the last one was shown a moment ago; `always` shows it in any case.
  void show(std::int64_t done, std::int64_t all, const std::string& status, bool always = false);

  // Shows the caller's own line, beside a bar that is filled to this share.
  void show_line(const std::string& line, double share);

  // Ends a bar's line.
  void finish();

 private:
  bool is_due(bool always);
  void write(std::string line, double share);

  using Clock = std::chrono::steady_clock;

  bool terminal_;
  std::string unit_;
  std::int64_t first_;
  double quiet_s_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_;
  bool line_open_ = false;
};

}  // namespace graphdrl
