// Wall-clock seconds for timings, which never enter results.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace isthmus {

/// Appends (name, seconds since the last lap) to a list of timings.
class Stopwatch {
 public:
  explicit Stopwatch(std::vector<std::pair<std::string, double>>& laps) : laps_(laps) {}
  void lap(std::string name) {
    const auto now = std::chrono::steady_clock::now();
    laps_.emplace_back(std::move(name), std::chrono::duration<double>(now - last_).count());
    last_ = now;
  }

 private:
  std::vector<std::pair<std::string, double>>& laps_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace isthmus
