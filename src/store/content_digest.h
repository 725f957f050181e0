// The digest of a file's bytes, remembered in the store so that unchanged files are not read again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "store/store.h"

namespace isthmus::store {

/// XXH3 (32 hex digits) of the file's bytes. The answer of an earlier run is taken when path, size, modification time
/// (to the nanosecond) and inode are the same; a file changed less than two seconds before it is read is never
/// remembered, since a second change in the same tick of the file system's clock could not be told from the first.
Result<std::string> content_digest(const std::filesystem::path& path, const Store& store);

/// The same as far as it is remembered: nothing when the file would have to be read.
Result<std::optional<std::string>> remembered_digest(const std::filesystem::path& path, const Store& store);

}  // namespace isthmus::store
