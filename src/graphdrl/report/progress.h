// What a training says while it runs.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace graphdrl {

// Shows nothing, rather than fail, where the stream is closed. A bar that rewrites its line on a terminal, plain lines
// at intervals elsewhere.
class ProgressDisplay {
 public:
  // `unit`: what is counted, as "episode". `first`: how many were done when this session began, for the time left.
  ProgressDisplay(std::FILE* out, std::string unit, std::int64_t first);

  // Shows how many are done and the status, unless the last one was shown a moment ago; `always` shows it in any case.
  void show(std::int64_t done, std::int64_t all, const std::string& status, bool always = false);

  // The same with a line of one's own, beside a bar so full.
  void show_line(const std::string& line, double share);

  // Ends a bar's line.
  void finish();

 private:
  bool is_due(bool always);
  void write(std::string line, double share);

  using Clock = std::chrono::steady_clock;

  std::FILE* out_;
  bool terminal_;
  std::string unit_;
  std::int64_t first_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_;
  bool line_open_ = false;
};

}  // namespace graphdrl
