// What a reader hands to the sampler: the header of one scan and chunks of its points (frames: see io/scan_reader.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/transform.h"

namespace isthmus {

struct ScanHeader {
  std::string format;                       ///< "ply", "pcd", "ptx", ...
  std::optional<std::uint64_t> num_points;  ///< by the file's own header
  Eigen::Vector3d local_origin_in_scan = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> station_in_scan;  ///< where the file says the scanner stood (PCD; E57, PTX: zero)
  std::optional<Transform> file_from_scan;         ///< the registered pose the file stores for the scan, if any
  bool has_intensity = false;
  bool has_colour = false;
  std::vector<std::string> notes;  ///< what was detected or assumed: "columns x y z intensity, delimiter ','"
};

/// Points as structure of arrays; optional arrays are empty or as long as `points`.
struct PointChunk {
  std::vector<Eigen::Vector3f> points;  ///< in the local frame, metres as stored; may hold NaN: the sampler drops them
  std::vector<float> intensity;
  std::vector<std::array<std::uint8_t, 3>> colour;
  void clear() {
    points.clear();
    intensity.clear();
    colour.clear();
  }
};

}  // namespace isthmus
