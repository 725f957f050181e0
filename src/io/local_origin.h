// Map coordinates lose millimetres as floats: readers subtract a round origin in double first.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace isthmus::io {

/// Coordinates beyond this are shifted: a float32 step at 10 km is 1 mm.
inline constexpr double kFarFromZero_m = 10000.0;

/// The origin the points around `sample` are stored against: zero on each axis whose median lies within 10 km, else
/// that median rounded to whole 100 m (so that scans of one site share it nearly always). Points that are not finite
/// and points exactly at zero (no-returns) do not count. A median, because the first point may be an outlier.
Eigen::Vector3d local_origin_of(const std::vector<Eigen::Vector3d>& sample);

}  // namespace isthmus::io
