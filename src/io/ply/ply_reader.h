// PLY files as scans: the vertex element, wherever it stands. The grammar is in ply_header.h.
#pragma once

#include "io/ply/ply_header.h"
#include "io/probing_reader.h"

namespace isthmus::io {

OpenedScan open_ply(const ScanRef& scan);

/// Where the coordinates, intensity and colour of a vertex without lists lie.
RecordLayout ply_vertex_layout(const PlyElement& vertex, bool swap_bytes);

}  // namespace isthmus::io
