// Is this point where the scanner stood? Asked of the points, not of the file.
#pragma once

#include <Eigen/Core>
#include <span>

namespace isthmus {

struct StationCheck {
  double blocked = 1;  ///< share of sight lines to points that pass through another surface: about 0 at a true station
  double concentration = 1;  ///< length of the mean direction to the points: 0 all round, 1 one direction
  double median_range_m = 0;
};

/// Casts up to 1500 sight lines from `station` through the surface points. `normals` may have any sign.
StationCheck check_station(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                           float voxel_m, const Eigen::Vector3f& station);

}  // namespace isthmus
