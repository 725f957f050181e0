// Registered scans as E57 files with their poses.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"
#include "io/e57/e57_writer.h"
#include "io/scan_reader.h"

namespace isthmus::pipelines {

struct PlacedScan {
  io::ScanRef scan;
  Transform file_from_scan = Transform::Identity();  ///< the pose to be written
};

/// Begins the scan in the file, with its pose and with doubles where it has a local origin; its points are to be added.
Result<std::unique_ptr<io::ScanReader>> begin_station(io::E57Writer& writer, const PlacedScan& placed);

/// All scans into one E57 file: positions as floats (doubles where the scan has a local origin), intensity and colour
/// if the scan has them. Scans that are all of one E57 file are copied instead, their points bit for bit.
/// `coordinates`: the reference system of the poses' frame, for the file to state; empty: none.
Result<void> export_e57_file(const std::filesystem::path& path, const std::vector<PlacedScan>& scans,
                             const std::string& coordinates);

/// One E57 file per file of scans, under its place relative to `base`, extension replaced. E57 files are copied, their
/// points bit for bit, without the scans that are not in `scans`. Returns the files written.
Result<std::vector<std::filesystem::path>> export_e57_folder(const std::filesystem::path& folder,
                                                             const std::filesystem::path& base,
                                                             const std::vector<PlacedScan>& scans,
                                                             const std::string& coordinates);

}  // namespace isthmus::pipelines
