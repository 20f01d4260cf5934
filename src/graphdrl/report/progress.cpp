#include "graphdrl/report/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "graphdrl/report/terminal_picture.h"

namespace graphdrl {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kTerminalInterval{0.1};
constexpr Seconds kPlainInterval{10};
constexpr std::size_t kMaxBarWidth = 30;

std::string format_duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::lround(seconds));
  if (whole >= 3600) return fmt::format("{}h{:02}m", whole / 3600, whole / 60 % 60);
  return fmt::format("{}m{:02}s", whole / 60, whole % 60);
}

}  // namespace

ProgressDisplay::ProgressDisplay(std::string unit, std::int64_t first, double quiet_s)
    : terminal_(isatty(fileno(stderr)) != 0),
      unit_(std::move(unit)),
      first_(first),
      quiet_s_(quiet_s),
      last_shown_(start_) {}

void ProgressDisplay::show(std::int64_t done, std::int64_t all, const std::string& status, bool always) {
  if (!is_due(always)) return;
  const double elapsed_s = Seconds(last_shown_ - start_).count();
  const double left_s =
      done > first_ ? elapsed_s / static_cast<double>(done - first_) * static_cast<double>(all - done) : NAN;
  write(fmt::format("{}/{}  {}  {} left", done, all, status,
                    std::isnan(left_s) ? std::string("-") : format_duration(left_s)),
        static_cast<double>(done) / static_cast<double>(all));
}

void ProgressDisplay::show_line(const std::string& line, double share) {
  if (is_due(/*always=*/false)) write(line, share);
}

bool ProgressDisplay::is_due(bool always) {
  const Clock::time_point now = Clock::now();
  const bool early =
      now - start_ < Seconds(quiet_s_) || now - last_shown_ < (terminal_ ? kTerminalInterval : kPlainInterval);
  if (early && !always) return false;
  last_shown_ = now;
  return true;
}

void ProgressDisplay::write(std::string line, double share) {
  if (!terminal_) {
    std::fputs((unit_ + " " + line + '\n').c_str(), stderr);
  } else {
    // The bar takes what room the numbers leave.
    const auto columns = static_cast<std::size_t>(screen_of(stderr).columns);
    const std::size_t room = columns > line.size() + 4 ? std::min(columns - line.size() - 4, kMaxBarWidth) : 0;
    const auto filled = static_cast<std::size_t>(static_cast<double>(room) * std::clamp(share, 0.0, 1.0));
    if (room > 0) line = fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(room - filled, '.'), line);
    if (line.size() > columns) line.resize(columns);
    std::fputs(("\r" + line + "\033[K").c_str(), stderr);
    line_open_ = true;
  }
  std::fflush(stderr);
}

void ProgressDisplay::finish() {
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

}  // namespace graphdrl
