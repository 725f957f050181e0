// Writing scans: PLY (binary little endian), PCD (binary), E57 and XYZ text, by extension.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/scan_reader.h"

namespace isthmus::io {

struct WriteOptions {
  /// Added to every point in double before it is written: p_in_scan = p_in_local + local_origin_in_scan.
  Eigen::Vector3d local_origin_in_scan = Eigen::Vector3d::Zero();
  /// Coordinates as float64; absent: float64 exactly if local_origin_in_scan is not zero.
  std::optional<bool> double_coordinates;
  std::optional<Eigen::Vector3d> station_in_scan;  ///< kept by PCD (VIEWPOINT); the other formats have no place for it
  std::optional<Transform> file_from_scan = {};    ///< kept by E57
  std::vector<std::string> comments;               ///< one line each, into the header of PLY and PCD
};

/// Writes the points (and intensity and colour, if present) to `path` in pieces; the file appears by rename when it is
/// whole. Fails if the extension is none of ply, pcd, e57, xyz, or if an optional array is neither empty nor as long as
/// the points. XYZ columns: x y z [intensity] [r g b], coordinates with 6 decimals. In E57 the scan is named as the
/// file without its extension.
Result<void> write_scan(const std::filesystem::path& path, const PointChunk& points, const WriteOptions& options = {});

}  // namespace isthmus::io
