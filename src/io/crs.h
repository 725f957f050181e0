// Coordinate reference systems as a person names them and as files state them. Nothing is looked up: whether a code
// exists, and what it means, is for the program that reads the file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace isthmus::io {

struct Crs {
  std::string text;  ///< WKT, or "EPSG:25832", "EPSG:25832+7837"
  std::optional<std::uint16_t> epsg, vertical_epsg;

  [[nodiscard]] bool is_wkt() const { return !epsg.has_value(); }
};

/// An EPSG code of a projected system, with one of a height system behind a plus sign if wanted, or WKT (version 1 or
/// 2): a system's keyword and brackets that close. Fails on anything else.
Result<Crs> parse_crs(std::string_view text);

/// The value of the GeoKeyDirectoryTag for the codes: projected, metres. Source: "GeoTIFF 1.0", Ritter and Ruth 2000,
/// 2.4 and 6.2.
std::string geo_key_directory(const Crs& crs);

}  // namespace isthmus::io
