// Who works in a store: any number of runs together, or one that removes things alone.
#pragma once

#include <filesystem>
#include <utility>

#include "base/error.h"

namespace isthmus::store {

/// Holds STORE/.lock by flock(2), which dies with its owner. A folder that cannot be written, or a file system that
/// knows no locks, is trusted.
class StoreLock {
 public:
  enum class Kind { shared, exclusive };
  /// Fails at once when others hold it the other way.
  static Result<StoreLock> take(const std::filesystem::path& folder, Kind kind);
  StoreLock(StoreLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  StoreLock& operator=(StoreLock&&) = delete;
  ~StoreLock();

 private:
  explicit StoreLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace isthmus::store
