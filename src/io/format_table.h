// The table of formats: which extension is read by whom. docs/formats.md says the same in words.
#pragma once

#include <span>

#include "io/probing_reader.h"

namespace isthmus::io {

struct Format {
  std::string_view name;         ///< as in ScanHeader::format
  std::string_view extensions;   ///< lower case, without dots, separated by blanks
  std::string_view description;  ///< one line for a person
  OpenedScan (*open)(const ScanRef& scan) = nullptr;
  /// The scans of a file that can hold several; absent: a file is one scan.
  Result<std::vector<ScanRef>> (*scans)(const std::filesystem::path& path) = nullptr;
};

/// In the order in which one is preferred when the same scan lies there in two formats: what stores the station and the
/// pose first, then full precision, then text.
std::span<const Format> formats();

/// The format by the path's extension (case does not matter); an error 'unsupported format' otherwise.
Result<const Format*> format_of(const std::filesystem::path& path);

/// Place of the path's extension in that order, smaller is preferred; formats that cannot be read come last.
std::size_t preference_of(const std::filesystem::path& path);

/// The extension belongs to a scan format, though one we cannot read (LAZ, makers' own formats).
bool is_known_but_unsupported(const std::filesystem::path& path);

/// Opens the scan with its probing side.
OpenedScan open_probing(const ScanRef& scan);

}  // namespace isthmus::io
