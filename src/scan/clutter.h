// Points that float evenly in the air, told from surfaces by what chance alone would give.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace isthmus {

/// The occupied voxels of a scan: their points and how many raw points each stands for.
struct OccupiedVoxels {
  std::span<const Eigen::Vector3f> points;
  std::span<const std::uint32_t> counts;
  float voxel_m = 0;
};

/// Raw points a voxel of space that float between the surfaces, if they do so evenly: the density of clutter. 0 where
/// nothing floats there, or not evenly (foliage), or where too little lies between surfaces to tell.
double clutter_density(const OccupiedVoxels& voxels);

/// The smallest count that an even spread with this expected number reaches in less than three of a thousand places
/// (Poisson).
std::uint32_t least_count_beyond_chance(double expected);

/// Which voxels are clutter (1): those with no more raw points beside them than an even spread of this density gives by
/// chance (counted in a slab of 1.5 voxels, 3.2 voxels around, along the plane that fits what is there), and those that
/// themselves hold no more than chance while their neighbours hold many times as much (clutter just before a wall). All
/// 0 for a density of 0.
std::vector<std::uint8_t> find_clutter(const OccupiedVoxels& voxels, double density);

}  // namespace isthmus
