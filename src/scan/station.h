// Is this point where the scanner stood? Asked of the points, not of the file.
#pragma once

#include <Eigen/Core>
#include <span>

#include "geometry/surface_lookup.h"

namespace isthmus {

struct StationCheck {
  double blocked = 1;  ///< share of sight lines to points that pass through another surface: about 0 at a true station
  double concentration = 1;  ///< length of the mean direction to the points: 0 all round, 1 one direction
  double median_range_m = 0;
};

/// Asks for one place after another whether the scanner stood there. Keeps references to the points.
class SightLines {
 public:
  /// `normals` may have any sign.
  SightLines(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals, float voxel_m);

  /// Casts up to 1500 sight lines from `station` through the surface points.
  [[nodiscard]] StationCheck from(const Eigen::Vector3f& station) const;

 private:
  std::span<const Eigen::Vector3f> points_, normals_;
  float voxel_m_;
  SurfaceLookup lookup_;
};

}  // namespace isthmus
