// Text files with a point per line. The grammar is in text_table.h; what was detected is said in the notes.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// .xyz .txt .csv .asc: any table with coordinates.
OpenedScan open_xyz(const ScanRef& scan);

/// Leica PTS: a line with the number of points, then x y z [intensity] [r g b], in a frame shared by all stations:
/// where the scanner stood is not known.
OpenedScan open_pts(const ScanRef& scan);

/// 3DTK .3d: x right, y up, z forward in centimetres (left-handed), read as metres with x forward, y left, z up:
/// (x, y, z) in metres = (z, -x, y) / 100 of the file. Source: 3DTK, doc/ and scan formats "uos".
OpenedScan open_3dtk(const ScanRef& scan);

/// False for a readable text file that holds no coordinates (prose, other tables). True if in doubt.
bool may_hold_coordinates(const std::filesystem::path& path);

}  // namespace isthmus::io
