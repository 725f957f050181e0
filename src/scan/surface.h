// Surface normals of a sampled scan: estimated from per-voxel moments, oriented to the station or consistently
// outwards.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace isthmus {

/// Moments of the raw points of one voxel.
struct VoxelMoments {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();  ///< of the raw points about the mean (zero for a single point)
};

struct SurfaceEstimate {
  std::vector<Eigen::Vector3f> normals;  ///< unit, sign undetermined
  std::vector<float> variation;          ///< l0/(l0+l1+l2); 1 where the neighbourhood does not determine a normal
  std::vector<std::uint32_t>
      neighbours;  ///< number of voxels within the smallest radius used, the voxel itself included
};

/// Principal component normals (Hoppe et al. 1992) over the voxels within 2.2 voxels, each voxel weighing the same
/// whatever its number of raw points; where these are too few or lie on a line (rings of a spinning scanner) the radius
/// grows to 4.5 voxels.
SurfaceEstimate estimate_surface(std::span<const VoxelMoments> voxels, float voxel_m);

/// Turns every normal towards `station`.
void orient_to_station(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& station,
                       std::span<Eigen::Vector3f> normals);

/// Orientation without a station: signs spread over a minimum spanning tree of |n_i . n_j| (Hoppe et al. 1992,
/// section 3.3), then each connected part is turned so that most of it faces away from the centroid of all points.
void orient_outwards(std::span<const Eigen::Vector3f> points, float voxel_m, std::span<Eigen::Vector3f> normals);

/// Gives each of `normals` the sign of the oriented normals around it, nearest coarse point first.
void orient_like(std::span<const Eigen::Vector3f> coarse_points, std::span<const Eigen::Vector3f> coarse_normals,
                 float voxel_m, std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> normals);

}  // namespace isthmus
