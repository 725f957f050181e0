// The digest of a file's bytes, remembered in the store so that unchanged files are not read again.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "store/store.h"

namespace isthmus::store {

/// What tells one state of a file from another without reading it: size, modification seconds, nanoseconds, inode. Not
/// the device: a shared file system has another number on every machine that mounts it.
using FileIdentity = std::array<std::int64_t, 4>;
Result<FileIdentity> identity_of(const std::filesystem::path& path);

/// XXH3 (32 hex digits) of the file's bytes. The answer of an earlier run is taken when path, size, modification time
/// (to the nanosecond) and inode are the same; a file changed less than two seconds before it is read is never
/// remembered, since a second change in the same tick of the file system's clock could not be told from the first.
/// Fails when the file changes while it is read.
Result<std::string> content_digest(const std::filesystem::path& path, const Store& store);

/// The same as far as it is remembered: nothing when the file would have to be read.
Result<std::optional<std::string>> remembered_digest(const std::filesystem::path& path, const Store& store);

}  // namespace isthmus::store
