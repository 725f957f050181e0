// A scan's points as the 3D view of the page embeds them: an even sample in 9 bytes a point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>

#include "geometry/transform.h"
#include "scan/sampled_scan.h"

namespace isthmus::report {

struct ViewCloud {
  std::size_t num_points = 0;
  std::size_t num_available = 0;                  ///< before thinning
  double spacing_m = 0;                           ///< edge of the voxels that the points are from
  Eigen::Vector3d low = Eigen::Vector3d::Zero();  ///< corner of the box of the points, frame of the component
  double step_m = 0;                              ///< a point is low + step_m * (x, y, z)
  bool has_intensity = false;
  /// num_points x (x, y, z) as uint16, little endian; num_points x 2 bytes of the normal (octahedral, -127 to 127);
  /// then, if there is intensity, a byte each, from the darkest to the brightest hundredth. In random order, so that
  /// any first part is an even sample.
  std::string bytes;
};

/// At most `max_points` of the scan's finest sampling. `intensity` has a value for each point of that sampling, or is
/// empty. The same bytes for the same scan.
ViewCloud view_cloud(const SampledScan& scan, std::span<const float> intensity, const Transform& component_from_local,
                     std::size_t max_points);

}  // namespace isthmus::report
