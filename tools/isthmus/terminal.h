// Everything a person reads while the program runs, on standard error: a progress line on a terminal, plain lines
// elsewhere.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "base/error.h"
#include "pipelines/events.h"

namespace isthmus::cli {

class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Events that print here; valid as long as the terminal is. Any thread.
  pipelines::Events events();
  void say(const std::string& text);
  void warn(const std::string& text);
  void error(const Error& error);

 private:
  void print_line(const std::string& text);
  void progress(const std::string& stage, std::size_t done, std::size_t total);
  void clear_progress_line();

  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  bool is_terminal_ = false;
  std::string progress_line_;  ///< what stands on the last line of the terminal now
  std::string stage_;
  Clock::time_point stage_start_;
  Clock::time_point last_print_;
};

/// "1:05:09", "5:09", "9 s".
std::string duration_text(double seconds);

}  // namespace isthmus::cli
