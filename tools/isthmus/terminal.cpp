#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "pipelines/night.h"

namespace isthmus::cli {
namespace {

constexpr double kTerminalSeconds = 0.1;  // how often a progress line changes: an eye sees no more
constexpr double kLogSeconds = 10;        // how often a log gets a line

std::string words_of(const std::string& stage) {
  static const std::map<std::string, std::string> kWords = {{"look", "looking at scans"},
                                                            {"scans", "describing scans"},
                                                            {"pairs", "registering pairs"},
                                                            {"others", "waiting for other shards"}};
  const auto words = kWords.find(stage);
  return words == kWords.end() ? stage : words->second;
}

}  // namespace

std::string duration_text(double seconds) { return pipelines::clock_text(static_cast<long long>(std::ceil(seconds))); }

Terminal::Terminal() : is_terminal_(::isatty(STDERR_FILENO) == 1) {}

Terminal::~Terminal() {
  const std::lock_guard lock(mutex_);
  clear_progress_line();
}

pipelines::Events Terminal::events() {
  return {[this](pipelines::Severity severity, const std::string& text) {
            severity == pipelines::Severity::warning ? warn(text) : say(text);
          },
          [this](const std::string& stage, std::size_t done, std::size_t total) { progress(stage, done, total); }};
}

void Terminal::say(const std::string& text) {
  const std::lock_guard lock(mutex_);
  print_line(text);
}

void Terminal::warn(const std::string& text) {
  const std::lock_guard lock(mutex_);
  print_line("warning: " + text);
}

void Terminal::error(const Error& error) {
  const std::lock_guard lock(mutex_);
  print_line("error: " + error.text());
}

void Terminal::print_line(const std::string& text) {
  const std::string progress_line = progress_line_;
  clear_progress_line();
  fmt::print(stderr, "{}\n", text);
  if (!progress_line.empty()) {
    progress_line_ = progress_line;
    fmt::print(stderr, "{}", progress_line_);
    std::fflush(stderr);
  }
}

void Terminal::clear_progress_line() {
  if (progress_line_.empty()) return;
  fmt::print(stderr, "\r{:{}}\r", "", progress_line_.size());
  std::fflush(stderr);
  progress_line_.clear();
}

void Terminal::progress(const std::string& stage, std::size_t done, std::size_t total) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const bool new_stage = stage != stage_;
  if (new_stage) {
    stage_ = stage;
    stage_start_ = now;
  }
  const auto since = [&](Clock::time_point then) { return std::chrono::duration<double>(now - then).count(); };
  const bool last = done == total;
  if (!new_stage && !last && since(last_print_) < (is_terminal_ ? kTerminalSeconds : kLogSeconds)) return;
  last_print_ = now;
  std::string line = fmt::format("{}: {} of {}", words_of(stage), done, total);
  const double seconds = since(stage_start_);
  if (done > 1 && seconds > 0) {
    // The first item started the clock, so that the rate counts the others.
    const double rate = static_cast<double>(done - 1) / seconds;
    line += fmt::format(", {:.3g}/s", rate);
    if (!last) line += fmt::format(", {} left", duration_text(static_cast<double>(total - done) / rate));
  }
  if (!is_terminal_) {
    fmt::print(stderr, "{}\n", line);
    return;
  }
  clear_progress_line();
  fmt::print(stderr, "{}", line);
  std::fflush(stderr);
  progress_line_ = line;
}

}  // namespace isthmus::cli
