// Bounds what is in flight: work starts when the bytes it will hold fit beside those of the work already started.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>

namespace isthmus::pipelines {

/// First come, first served. Something larger than the whole bound starts when nothing else is in flight.
class ByteGate {
 public:
  ByteGate(std::size_t max_bytes, std::size_t max_items) : max_bytes_(max_bytes), max_items_(max_items) {}

  /// Calls `start` now or, from within a later release(), when `bytes` fit. Any thread.
  void submit(std::size_t bytes, std::function<void()> start);
  /// Gives back what a started item was submitted with.
  void release(std::size_t bytes);
  /// The largest number of bytes that was in flight at once.
  [[nodiscard]] std::size_t peak_bytes() const;

 private:
  struct Waiting {
    std::size_t bytes;
    std::function<void()> start;
  };
  /// Takes those out of the queue that may start now.
  std::deque<Waiting> admit();

  std::size_t max_bytes_;
  std::size_t max_items_;
  mutable std::mutex mutex_;
  std::deque<Waiting> waiting_;
  std::size_t bytes_ = 0;
  std::size_t items_ = 0;
  std::size_t peak_bytes_ = 0;
};

}  // namespace isthmus::pipelines
