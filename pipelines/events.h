// What a running pipeline tells: only the program prints.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace isthmus::pipelines {

enum class Severity { info, warning };

/// Called from any thread, one call at a time is not promised; empty functions are allowed.
struct Events {
  std::function<void(Severity, const std::string& text)> message;
  /// `done` of `total` items of a stage ("scans", "pairs") are finished; total may grow.
  std::function<void(const std::string& stage, std::size_t done, std::size_t total)> progress;

  void info(const std::string& text) const {
    if (message) message(Severity::info, text);
  }
  void warn(const std::string& text) const {
    if (message) message(Severity::warning, text);
  }
  void advance(const std::string& stage, std::size_t done, std::size_t total) const {
    if (progress) progress(stage, done, total);
  }
};

}  // namespace isthmus::pipelines
