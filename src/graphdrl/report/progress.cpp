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
constexpr int kBarWidth = 20;

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
      fmt::format("episode {}/{}  coverage {:.1f} %  reward {:.2f}  loss {}  epsilon {:.3f}  {:.0f} steps/s  {} left",
                  status.episode, status.episodes, status.coverage, status.reward,
                  std::isnan(status.loss) ? std::string("–") : fmt::format("{:.4f}", status.loss), status.epsilon,
                  static_cast<double>(status.steps_this_session) / std::max(elapsed_s, 1e-9),
                  std::isnan(left_s) ? std::string("–") : format_duration(left_s));
  if (!terminal_) {
    fmt::print(out_, "{}\n", line);
  } else {
    const auto filled =
        static_cast<std::size_t>(kBarWidth * status.episode / std::max<std::int64_t>(status.episodes, 1));
    line = fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(kBarWidth - filled, '.'), line);
    const std::size_t columns = terminal_columns(out_);
    if (line.size() > columns) line.resize(columns);
    fmt::print(out_, "\r{}\033[K", line);
    line_open_ = true;
  }
  std::fflush(out_);
}

void ProgressDisplay::finish() {
  if (line_open_) fmt::print(out_, "\n");
  line_open_ = false;
}

}  // namespace graphdrl
