// The header of a PLY file.
//
//   ply
//   format ascii|binary_little_endian|binary_big_endian 1.0
//   comment ... | obj_info ...
//   element NAME COUNT
//   property TYPE NAME                          TYPE: char uchar short ushort int uint float double, or int8 ...
//   float64 property list COUNT_TYPE TYPE NAME end_header
//
// Elements follow in the order of the header; in ascii files one per line. Source: G. Turk, "The PLY polygon file
// format" (1994). Differences: names of types as CloudCompare, PDAL and libply write them; unknown header lines are
// ignored with a note (the Stanford dragon scans hold lines "bye").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/input_file.h"
#include "io/record_layout.h"

namespace isthmus::io {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::optional<ScalarType> list_count_type;  ///< present: a list of `type`, its length stored before it
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const;
  /// Bytes of one element in a binary file. Precondition: no lists.
  [[nodiscard]] std::uint64_t fixed_bytes() const;
};

struct PlyHeader {
  enum class Encoding { ascii, little_endian, big_endian };
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t vertex = 0;  ///< index of the element "vertex"
  std::uint64_t data_begin = 0;
  std::uint64_t data_line = 0;  ///< line number of the first line behind the header
  std::vector<std::string> notes;
};

/// Reads the header; the file then stands at data_begin. Fails without a vertex element or without x and y in it.
Result<PlyHeader> read_ply_header(InputFile& file);

}  // namespace isthmus::io
