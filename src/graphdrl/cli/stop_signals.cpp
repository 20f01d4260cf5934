#include "graphdrl/cli/stop_signals.h"

#include <csignal>

namespace graphdrl {
namespace {

constexpr int kStopSignals[] = {SIGINT, SIGTERM, SIGHUP};

std::atomic<int> caught = 0;
std::atomic<bool> stopped = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler writes them");

using Handler = void (*)(int);

// Gives a signal a handler unless it has `kept`.
void handle(int signal, Handler handler, Handler kept) {
  struct sigaction now {};
  sigaction(signal, nullptr, &now);
  if (now.sa_handler == kept) return;
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

extern "C" void remember_stop_signal(int signal) {
  caught = signal;
  stopped = true;
  for (const int each : kStopSignals) handle(each, SIG_DFL, SIG_IGN);
}

}  // namespace

void catch_stop_signals() {
  for (const int signal : kStopSignals) handle(signal, remember_stop_signal, SIG_IGN);
}

int stop_signal() {
  return caught;
}

const std::atomic<bool>& stop_flag() {
  return stopped;
}

}  // namespace graphdrl
