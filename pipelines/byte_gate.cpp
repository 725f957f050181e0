#include "pipelines/byte_gate.h"

#include <algorithm>
#include <utility>

namespace isthmus::pipelines {

std::deque<ByteGate::Waiting> ByteGate::admit() {
  std::deque<Waiting> admitted;
  while (!waiting_.empty()) {
    const std::size_t bytes = waiting_.front().bytes;
    const bool fits = items_ < max_items_ && bytes_ + bytes <= max_bytes_;
    if (!fits && items_ > 0) break;
    bytes_ += bytes;
    ++items_;
    peak_bytes_ = std::max(peak_bytes_, bytes_);
    admitted.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  return admitted;
}

void ByteGate::submit(std::size_t bytes, std::function<void()> start) {
  std::deque<Waiting> admitted;
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({bytes, std::move(start)});
    admitted = admit();
  }
  for (Waiting& item : admitted) item.start();  // outside the lock: it may submit or release in turn
}

void ByteGate::release(std::size_t bytes) {
  std::deque<Waiting> admitted;
  {
    const std::lock_guard lock(mutex_);
    bytes_ -= bytes;
    --items_;
    admitted = admit();
  }
  for (Waiting& item : admitted) item.start();
}

std::size_t ByteGate::peak_bytes() const {
  const std::lock_guard lock(mutex_);
  return peak_bytes_;
}

}  // namespace isthmus::pipelines
