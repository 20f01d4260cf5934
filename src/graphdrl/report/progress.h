// What a training says while it runs.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>

namespace graphdrl {

// Means over the episodes since the last line of metrics, except where said.
struct TrainingStatus {
  std::int64_t episode;   // done
  std::int64_t episodes;  // in all
  double coverage;        // percent
  double reward;
  double loss;     // not a number before learning starts
  double epsilon;  // now
  std::int64_t steps_this_session;
};

// Shows nothing, rather than fail, where the stream is closed. A bar that rewrites its line on a terminal, plain lines
// at intervals elsewhere.
class ProgressDisplay {
 public:
  // `first_episode`: where this session begins, for the time left.
  ProgressDisplay(std::FILE* out, std::int64_t first_episode);

  // Shows the status unless the last one was shown a moment ago; `always` shows it in any case.
  void show(const TrainingStatus& status, bool always = false);

  // Ends a bar's line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::FILE* out_;
  bool terminal_;
  std::int64_t first_episode_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_;
  bool line_open_ = false;
};

}  // namespace graphdrl
