// Removes from a store what nobody needs.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "base/error.h"

namespace isthmus::store {

/// Which of the artifacts that are not needed stay all the same. Both absent: none.
struct CollectLimits {
  std::optional<std::chrono::seconds> keep_younger_than;  ///< by the time the artifact was made
  std::optional<std::uint64_t> max_bytes;  ///< of the whole store: the youngest stay that fit beside those needed
};

struct Collected {
  std::size_t num_needed = 0;
  std::size_t num_kept = 0;  ///< not needed, but within the limits
  std::size_t num_removed = 0;
  std::uint64_t bytes_left = 0;
  std::uint64_t bytes_removed = 0;
};

/// `needed` as "<stage>/<digest>". Halves of files that killed runs left behind go as well. Nothing else in the folder
/// is touched. With `dry_run` the answer is the same and nothing is removed. Fails when another process uses the store
/// (Store::open) or when something cannot be removed.
Result<Collected> collect(const std::filesystem::path& folder, const std::set<std::string>& needed,
                          const CollectLimits& limits, bool dry_run);

/// Outputs whose runs said that they use the store (Store::add_user) and that still exist.
std::set<std::filesystem::path> users_of(const std::filesystem::path& folder);

}  // namespace isthmus::store
