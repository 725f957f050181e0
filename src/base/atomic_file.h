// Files appear by rename: a reader sees the old file, the new file, never half of one.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/error.h"

namespace isthmus {

/// Writes `content` to a temporary file beside `path`, syncs it and renames it over `path`.
/// Fails with the path and the system's reason (disk_space.h: on a full disk with the bytes that were needed and are
/// free); leaves no temporary file behind.
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// The whole file as bytes, or an error that names it.
Result<std::string> read_file(const std::filesystem::path& path);

}  // namespace isthmus
