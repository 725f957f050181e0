// Names of scans: one word each, the same in every output file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace isthmus::io {

/// The path with '/' between its parts, white space, control bytes, '#' and '%' percent-encoded; "#k" behind it if
/// `index` is given (the file holds several scans; k counts from 0).
std::string scan_name(const std::filesystem::path& relative_path, std::optional<int> index);

/// Undoes the percent-encoding; malformed escapes stay as they are.
std::string percent_decoded(std::string_view text);

}  // namespace isthmus::io
