// ASPRS LAS 1.0 to 1.4, point formats 0 to 10, without compression.
//
// Header (little endian): 0 "LASF", 24 version major minor, 94 header size, 96 offset of the points, 104 point format,
// 105 bytes per point, 107 number of points (32 bits), 131 scale x y z, 155 offset x y z, from 1.4 on 247 number of
// points (64 bits). Point: int32 x y z at 0 4 8 (value = raw * scale + offset), uint16 intensity at 12, colour by
// format. Variable length records are passed over. Source: "LAS specification 1.4 - R15", ASPRS 2019.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// A compressed file (LAZ under the name .las) is 'unsupported'. Coordinates are in the map's frame; no station is
/// known.
OpenedScan open_las(const ScanRef& scan);

}  // namespace isthmus::io
