// ASTM E2807 (E57) files with points; the grammar is in words in e57_pages.h, e57_file.h, e57_scan.h and e57_packets.h.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// From header and XML alone; scans without points and scans we cannot read are listed too and fail when they are
/// opened.
Result<std::vector<ScanRef>> scans_of_e57(const std::filesystem::path& path);

/// Points in the scan's own frame: Cartesian, else spherical (range, azimuth, elevation from the horizontal). Points
/// whose invalid state is not 0 are left out and counted in a note. Station: the origin. file_from_scan: the stored
/// pose. Intensity as stored, colour by its limits as 0..255; other fields are passed over.
OpenedScan open_e57(const ScanRef& scan);

}  // namespace isthmus::io
