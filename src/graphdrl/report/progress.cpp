#include "graphdrl/report/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <string>

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

std::size_t terminal_columns(std::FILE* out) {
  winsize size{};
  return ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

ProgressDisplay::ProgressDisplay(std::FILE* out, std::int64_t first_episode)
    : out_(out), terminal_(isatty(fileno(out)) != 0), first_episode_(first_episode), last_shown_(start_) {}

void ProgressDisplay::show(const TrainingStatus& status, bool always) {
  const Clock::time_point now = Clock::now();
  if (!always && now - last_shown_ < (terminal_ ? kTerminalInterval : kPlainInterval)) return;
  last_shown_ = now;

  const double elapsed_s = Seconds(now - start_).count();
  const std::int64_t done = status.episode - first_episode_;
  const double left_s =
      done > 0 ? elapsed_s / static_cast<double>(done) * static_cast<double>(status.episodes - status.episode) : NAN;
  std::string line =
      fmt::format("{}/{}  coverage {:.1f} %  reward {:.2f}  loss {}  eps {:.3f}  {:.0f} steps/s  {} left",
                  status.episode, status.episodes, status.coverage, status.reward,
                  std::isnan(status.loss) ? std::string("-") : fmt::format("{:.4f}", status.loss), status.epsilon,
                  static_cast<double>(status.steps_this_session) / std::max(elapsed_s, 1e-9),
                  std::isnan(left_s) ? std::string("-") : format_duration(left_s));
  if (!terminal_) {
    std::fputs(("episode " + line + '\n').c_str(), out_);
  } else {
    // The bar takes what room the numbers leave.
    const std::size_t columns = terminal_columns(out_);
    const std::size_t room = columns > line.size() + 4 ? std::min(columns - line.size() - 4, kMaxBarWidth) : 0;
    const auto filled = room * static_cast<std::size_t>(status.episode) / static_cast<std::size_t>(status.episodes);
    if (room > 0) line = fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(room - filled, '.'), line);
    if (line.size() > columns) line.resize(columns);
    std::fputs(("\r" + line + "\033[K").c_str(), out_);
    line_open_ = true;
  }
  std::fflush(out_);
}

void ProgressDisplay::finish() {
  if (line_open_) std::fputc('\n', out_);
  line_open_ = false;
}

}  // namespace graphdrl
