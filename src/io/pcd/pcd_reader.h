// PCD files as scans. The grammar is in pcd_header.h.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// Ascii and binary files are streamed; a compressed one is a single LZF block and is held decompressed in memory while
/// the scan is open (the format leaves no choice). VIEWPOINT becomes the station unless it is the default 0 0 0.
OpenedScan open_pcd(const ScanRef& scan);

}  // namespace isthmus::io
