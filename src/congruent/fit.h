// Closed-form rigid fit of a few corresponding points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

#include "geometry/transform.h"

namespace isthmus::congruent {

struct RigidFit {
  Transform target_from_source = Transform::Identity();
  double rms_m = 0;
};

/// Least squares over corresponding points, a proper rotation always (Arun, Huang, Blostein 1987; the sign as in
/// Umeyama 1991). Nothing when the points do not fix a rotation: fewer than three, or all on a line,
/// within rounding. Exact for three or more points that are not collinear, coplanar ones included.
std::optional<RigidFit> fit_rigid(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target);

/// A quick pose from two diagonals ab and cd that are not parallel: their bisecting frames are laid onto each other and
/// their middles too. Not least squares, but within the corners' own errors, at a tenth of the cost.
class DiagonalFit {
 public:
  explicit DiagonalFit(const std::array<Eigen::Vector3d, 4>& source_abcd);
  [[nodiscard]] Transform operator()(const std::array<Eigen::Vector3d, 4>& target_abcd) const;

 private:
  Eigen::Matrix3d source_from_frame_;
  Eigen::Vector3d source_middle_;
};

}  // namespace isthmus::congruent
