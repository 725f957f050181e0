// The clouds that congruent sets are sought in: points with unit normals, and their recentred working copy.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/rng.h"

namespace isthmus {

/// A view of points (metres, the cloud's own frame) and their unit normals. `normals` is empty or as long as `points`.
struct OrientedCloud {
  std::span<const Eigen::Vector3f> points;
  std::span<const Eigen::Vector3f> normals;
  std::span<const std::uint8_t> at_boundary =
      {};  ///< as long as `points`: 1 at the boundary of the overlap; empty: unknown
};

namespace congruent {

/// Working copy: finite points relative to their mean, so that float arithmetic on it is exact to the input's own
/// resolution wherever the cloud lies (a float at 1e6 m resolves 0.06 m: such input has lost its detail before us).
struct LocalCloud {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of the kept points, in the cloud's own frame
  std::vector<Eigen::Vector3f> points;               ///< relative to `centre`, in input order
  std::vector<Eigen::Vector3f> normals;              ///< as many unit vectors, or empty when not used
  std::vector<std::uint32_t> boundary;               ///< kept points at the boundary of the overlap, ascending
  double diameter_m = 0;                             ///< robust: twice the distance from the centre that 90 % keep
  std::size_t num_dropped = 0;                       ///< points that were not finite or had no usable normal
};

/// Copies `cloud`, leaving out points with non-finite coordinates and, with `use_normals`, those without a usable
/// normal. Normals are made unit. Precondition: use_normals implies cloud.normals.size() == cloud.points.size();
/// at_boundary is empty or as long.
LocalCloud recentred(const OrientedCloud& cloud, bool use_normals);

/// One point of each cell of the edge given, and of each of six directions its normal may face, so that both sides of a
/// wall stay: the lowest index. An edge of 0 keeps all points. Centre and diameter stay those of the whole cloud; the
/// boundary is not kept: bases are drawn from whole clouds.
LocalCloud thinned_by_cells(const LocalCloud& cloud, double edge_m);

/// A random subset of at most `max_points`, in the order of the cloud.
LocalCloud thinned_by_lot(const LocalCloud& cloud, std::size_t max_points, Rng rng);

}  // namespace congruent
}  // namespace isthmus
