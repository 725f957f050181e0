// Which part of a survey's work one process may do.
#pragma once

#include <cstddef>
#include <string>

#include "base/error.h"

namespace isthmus::pipelines {

/// Shard `index` of `count`, from 0. Items (scans by id, pairs in the order in which a wave lists them) are dealt out
/// in turn; what belongs to others is taken from the store, or is missing.
struct Share {
  std::size_t index = 0;
  std::size_t count = 1;  ///< 0: nothing may be computed or written, to look ahead

  [[nodiscard]] bool is_whole() const { return count == 1; }
  [[nodiscard]] bool only_looks() const { return count == 0; }
  [[nodiscard]] bool has(std::size_t item) const { return count > 0 && item % count == index; }

  static Share nothing() { return {0, 0}; }
  /// "2/3": the second of three.
  static Result<Share> parse(const std::string& text);
};

}  // namespace isthmus::pipelines
