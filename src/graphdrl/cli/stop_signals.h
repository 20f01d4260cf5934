// Ctrl-C and its like: the first one ends the work in good order, the second one the program.
#pragma once

#include <atomic>

namespace graphdrl {

// Catches SIGINT, SIGTERM and SIGHUP from now on, but for those that the program was told to ignore, as by nohup. After
// the first one, each does again what it does by default.
void catch_stop_signals();

// The signal caught, 0 if none.
int stop_signal();

// True once one was caught.
const std::atomic<bool>& stop_flag();

}  // namespace graphdrl
