#include "stop_signal.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace isthmus::cli {
namespace {

// Signal handlers may touch nothing else than lock-free atomics, and those must be global.
std::atomic<bool> requested{false};
std::atomic<int> number{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void on_signal(int signal) {
  number = signal;
  requested = true;
  constexpr std::string_view kText = "\nstopping: work in flight is finished first; once more to stop at once\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText.data(), kText.size());
  std::signal(signal, SIG_DFL);
}

}  // namespace

const std::atomic<bool>& stop_requested() { return requested; }
int stop_signal() { return number; }

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace isthmus::cli
