// What a person must know when something cannot be written: which path, how much was wanted, how much is free.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/error.h"

namespace isthmus {

/// Bytes that this user may still write where `path` is, or will be: the nearest existing folder above counts.
std::optional<std::uint64_t> free_bytes_at(const std::filesystem::path& path);

/// "312 bytes", "1.2 MB": decimal units, two significant digits or more.
std::string bytes_text(std::uint64_t bytes);

/// The error of a system call on the way to a file, `error_number` its errno: "<what>: <the system's reason>". On a
/// full disk it says how many bytes were wanted and how many are free, and what to try.
Error write_error(const std::string& what, int error_number, const std::filesystem::path& path,
                  std::optional<std::uint64_t> wanted_bytes = std::nullopt);

}  // namespace isthmus
