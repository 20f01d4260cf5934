#include "graphdrl/base/clock.h"

#include <fmt/format.h>

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

std::chrono::steady_clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(std::min(seconds, Clock::kMostSeconds)));
}

}  // namespace

Clock::Clock(std::optional<double> seconds, const std::atomic<bool>* stop, const ProgressListener* listener)
    : stop_(stop), listener_(listener) {
  if (!seconds) return;
  if (!(*seconds >= 0 && *seconds <= kMostSeconds)) {
    throw Error({.what = "bad time limit",
                 .expected = fmt::format("0 to {:.0f} seconds", kMostSeconds),
                 .got = fmt::format("{}", *seconds)});
  }
  deadline_ = Steady::now() + duration_of(*seconds);
}

double Clock::seconds_left() const {
  if (!deadline_) return std::numeric_limits<double>::infinity();
  return std::chrono::duration<double>(*deadline_ - Steady::now()).count();
}

Clock Clock::share(double of_time_left) const {
  return deadline_ ? at_most(of_time_left * seconds_left()) : *this;
}

Clock Clock::at_most(double seconds) const {
  Clock clock = *this;
  const auto end = Steady::now() + duration_of(seconds);
  clock.deadline_ = deadline_ ? std::min(*deadline_, end) : end;
  return clock;
}

Clock Clock::sooner(double seconds) const {
  Clock clock = *this;
  if (deadline_) *clock.deadline_ -= duration_of(seconds);
  return clock;
}

}  // namespace graphdrl
