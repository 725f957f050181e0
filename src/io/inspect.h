// What a scan file holds, from one pass over it.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/scan_reader.h"

namespace isthmus::io {

struct ScanSummary {
  ScanHeader header;             ///< as after the last point: with the notes of the whole reading
  std::uint64_t num_read = 0;    ///< points delivered (without the no-return lines of PTX)
  std::uint64_t num_finite = 0;  ///< of them with three finite coordinates
  std::optional<Eigen::AlignedBox3d>
      extent_in_scan;               ///< of the finite points, metres as stored; absent if there are none
  std::optional<double> spacing_m;  ///< median distance to the nearest other point, from 256 places of the scan
  std::optional<std::pair<float, float>> intensity_range;  ///< absent without (finite) intensities
};

/// Streams the scan once (and probes it before), memory bounded by one chunk. The first error of the file is returned.
Result<ScanSummary> inspect_scan(const ScanRef& scan);

}  // namespace isthmus::io
