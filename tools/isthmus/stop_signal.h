// Ctrl-C and termination: the first asks the run to stop after the work in flight, the second ends the program at once.
#pragma once

#include <atomic>

namespace isthmus::cli {

/// Set by the first SIGINT or SIGTERM once catch_stop_signals() was called.
const std::atomic<bool>& stop_requested();
void catch_stop_signals();
/// The signal that came, 0 if none did.
int stop_signal();

}  // namespace isthmus::cli
