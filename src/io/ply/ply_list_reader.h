// PLY elements of varying length: lists among or before the vertices, in binary files.
#pragma once

#include "io/ply/ply_header.h"
#include "io/probing_reader.h"

namespace isthmus::io {

/// Moves `file` over `element.count` elements of a binary file.
Result<void> skip_ply_elements(InputFile& file, const PlyElement& element, bool swap_bytes);

/// A reader for vertices that contain lists (so that no two need have the same size). `file` stands at the first one.
OpenedScan open_ply_list_vertices(InputFile file, ScanHeader header, const PlyElement& vertex, bool swap_bytes);

}  // namespace isthmus::io
