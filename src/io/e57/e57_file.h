// An E57 file without its points: header and XML section.
//
// Header, 48 bytes little endian: 0 "ASTM-E57", 8 major, 12 minor version (uint32), 16 length of the file, 24 physical
// offset of the XML section, 32 its length in data bytes, 40 bytes per page (uint64). Source: ASTM E2807-11, section 7.
#pragma once

#include <filesystem>
#include <string>

#include "io/e57/e57_pages.h"

namespace isthmus::io {

inline constexpr std::size_t kE57HeaderBytes = 48;

struct E57Header {
  std::uint32_t major = 1, minor = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t xml_physical = 0, xml_bytes = 0;
};

struct E57File {
  E57Pages pages;
  E57Header header;
  std::string xml;
};

/// Fails if it is no E57 file of version 1 or is cut short, or if the pages of its XML are damaged. The XML is not
/// parsed.
Result<E57File> open_e57_file(const std::filesystem::path& path);

/// The header as the 48 bytes that stand in a file.
std::string e57_header_bytes(const E57Header& header);

}  // namespace isthmus::io
