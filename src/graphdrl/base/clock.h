// When work must end, who may stop it, and who hears how far it is.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>

namespace graphdrl {

// How far a planner is.
struct Progress {
  int visited;                                             // nodes, by the walk under way or by the best one
  double bound = std::numeric_limits<double>::infinity();  // no walk has a higher prize
};
using ProgressListener = std::function<void(const Progress&)>;

// A deadline, a flag that stops the work as if the deadline had passed, and a listener. Each is optional. A small
// value: copies share the flag and the listener, which must outlive them. A flag that is taken back lets work go on.
class Clock {
 public:
  static constexpr double kMostSeconds = 1e6;

  Clock() = default;
  // seconds: from now; empty for no deadline. Throws Error on other than 0 to kMostSeconds.
  explicit Clock(std::optional<double> seconds, const std::atomic<bool>* stop = nullptr,
                 const ProgressListener* listener = nullptr);

  bool has_deadline() const { return deadline_.has_value(); }
  bool stopped() const { return stop_ != nullptr && stop_->load(std::memory_order_relaxed); }
  bool passed() const { return stopped() || (deadline_ && Steady::now() >= *deadline_); }
  // Until the deadline, below 0 once it has passed; infinity without one.
  double seconds_left() const;

  // Clocks that pass earlier: share() after a share of the time left, at_most() after this many seconds from now,
  // sooner() this many seconds before this one. share() and sooner() have no deadline if this one has none.
  Clock share(double of_time_left) const;
  Clock at_most(double seconds) const;
  Clock sooner(double seconds) const;

  void tell(const Progress& progress) const {
    if (listener_ != nullptr && *listener_) (*listener_)(progress);
  }

 private:
  using Steady = std::chrono::steady_clock;

  std::optional<Steady::time_point> deadline_;
  const std::atomic<bool>* stop_ = nullptr;
  const ProgressListener* listener_ = nullptr;
};

// Measures how long something takes.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Looks at the clock once in `every` units of work, and tells the listener then.
class Ticker {
 public:
  static constexpr int kNodesPerUnit = 64;  // nodes met in a search that take as long as one unit

  Ticker(const Clock& clock, int every) : clock_(clock), every_(every) {}

  // Whether the clock has passed, after so many units of work. visited: by the walk under way.
  bool tick(int visited, int units = 1) {
    done_ += units;
    if (done_ < every_) return false;
    done_ = 0;
    clock_.tell({.visited = visited});
    return clock_.passed();
  }

 private:
  Clock clock_;
  int every_;
  int done_ = 0;
};

}  // namespace graphdrl
