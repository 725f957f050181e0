// The header of LAS and LAZ files.
//
// Little endian: 0 "LASF", 24 version major minor, 94 header size, 96 offset of the points, 100 number of variable
// length records, 104 point format (its upper two bits: compressed by LASzip), 105 bytes per point, 107 number of
// points (32 bits), 131 scale x y z, 155 offset x y z, 179 largest and smallest x, y, z, from 1.4 on 247 number of
// points (64 bits). Source: "LAS specification 1.4 - R15", ASPRS 2019.
#pragma once

#include <array>
#include <cstdint>

#include "io/input_file.h"
#include "io/scan_reader.h"

namespace isthmus::io {

struct LasPointFormat {
  std::size_t bytes;   ///< of the format itself; records may carry extra bytes
  std::size_t colour;  ///< offset of red green blue (uint16); 0 = none
};

struct LasHeader {
  unsigned major = 0, minor = 0;
  unsigned format = 0;      ///< 0 to 10
  bool compressed = false;  ///< by LASzip
  std::size_t header_bytes = 0, record_bytes = 0;
  std::uint32_t num_records = 0;  ///< of variable length, between header and points
  std::uint64_t points_begin = 0, num_points = 0;
  std::array<double, 3> scale = {}, offset = {};
  std::array<double, 3> low = {}, high = {};  ///< bounds as stated; many programs state wrong ones

  [[nodiscard]] const LasPointFormat& point_format() const;
};

/// Reads and checks it: what comes back can be read if the points are there.
Result<LasHeader> read_las_header(const InputFile& file);

/// What it tells of every scan: format and the note about version and point format.
ScanHeader scan_header_of(const LasHeader& las);

}  // namespace isthmus::io
