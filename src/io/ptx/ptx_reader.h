// Leica PTX: gridded scans, several may follow each other in one file. Each is
//
//   columns                     number of grid columns, then of rows, one per line
//   rows
//   x y z                       registered position of the scanner
//   x y z  (three lines)        its axes
//   m m m m  (four lines)       the registered pose for ROW vectors: the translation is the last row
//   x y z intensity [r g b]     columns*rows lines in the scanner's own frame; no return: 0 0 0 ...
//
// Source: Leica Geosystems, "Cyclone ptx format".
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// Counts lines over the whole file (the format has no index). A damaged part ends the list with an entry that cannot
/// be opened, so that the scans before it are not lost.
Result<std::vector<ScanRef>> scans_of_ptx(const std::filesystem::path& path);

/// No-return lines are left out and counted in a note. Station: the origin. file_from_scan: the stored matrix if rigid.
OpenedScan open_ptx(const ScanRef& scan);

}  // namespace isthmus::io
