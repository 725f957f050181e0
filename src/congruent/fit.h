// Closed-form rigid fit of a few corresponding points.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "geometry/transform.h"

namespace isthmus::congruent {

struct RigidFit {
  Transform target_from_source = Transform::Identity();
  double rms_m = 0;
};

/// Least squares over corresponding points, a proper rotation always (Arun, Huang, Blostein 1987; the sign as in
/// Umeyama 1991, equation 39). Nothing when the points do not fix a rotation: fewer than three, or all on a line,
/// within rounding. Exact for three or more points that are not collinear, coplanar ones included.
std::optional<RigidFit> fit_rigid(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target);

}  // namespace isthmus::congruent
