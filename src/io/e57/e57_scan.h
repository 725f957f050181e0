// What the XML section of an E57 file says about its scans (the children of data3D).
//
// Of the prototype every number field is one bytestream, in the order of the XML. Integer and ScaledInteger are stored
// as value minus minimum in as many bits as maximum minus minimum needs (none if they are equal); a ScaledInteger
// stands for raw * scale + offset; Float is single or double. Source: ASTM E2807-11, section 8.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::io {

enum class E57FieldKind : std::uint8_t { integer, float32, float64, other };

struct E57Field {
  std::string name;  ///< "cartesianX"; fields of an extension carry its prefix: "nor:normalX"
  E57FieldKind kind = E57FieldKind::other;
  std::int64_t minimum = 0, maximum = 0;  ///< of the raw integer
  unsigned bits = 0;                      ///< per record; 0 for 'other', whose length varies
  double scale = 1.0, offset = 0.0;       ///< value = raw * scale + offset
};

/// Declared smallest and largest value.
using E57Limits = std::optional<std::pair<double, double>>;

struct E57Scan {
  std::string guid, name, sensor;
  std::optional<Transform> file_from_scan;
  std::uint64_t section_physical = 0;  ///< where the compressed vector of the points begins
  std::uint64_t num_records = 0;
  std::vector<E57Field> fields;  ///< one per bytestream
  E57Limits intensity_limits;
  std::array<E57Limits, 3> colour_limits;
  std::vector<std::string> notes;
};

/// The number of scans; fails if the XML is damaged or is none of E57. `file` is the name for messages.
Result<std::size_t> num_e57_scans(const std::string& xml, const std::string& file);

/// Scan `index` from 0.
Result<E57Scan> e57_scan(const std::string& xml, int index, const std::string& file);

/// "<file>, scan #2 in its XML".
std::string at_e57_scan(std::string_view file, int index);

}  // namespace isthmus::io
