// ASPRS LAS 1.0 to 1.4, point formats 0 to 10, as it is or compressed (LAZ).
//
// Header: las_header.h. Point: int32 x y z at 0 4 8 (value = raw * scale + offset), uint16 intensity at 12, colour by
// format. Variable length records are passed over.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// Either kind under either extension; compressed points are 'unsupported' in a build without LASzip (laz.h).
/// Coordinates are in the map's frame; no station is known.
OpenedScan open_las(const ScanRef& scan);

}  // namespace isthmus::io
