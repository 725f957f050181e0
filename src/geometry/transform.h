// Rigid transforms. A name carries its frames: target_from_source maps p_in_source to p_in_target.
#pragma once

#include <Eigen/Geometry>

namespace isthmus {

using Transform = Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Angle of a rotation in radians, in [0, pi]; accurate near 0 (atan2 of sine and cosine, not acos of the trace).
double rotation_angle_rad(const Eigen::Matrix3d& rotation);

/// Distance in metres that `a` and `b` carry the point `p_in_source` apart.
double displacement_m(const Transform& a, const Transform& b, const Eigen::Vector3d& p_in_source);

/// Rotation from a rotation vector (axis times angle in radians).
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& rotation_vector);

/// The nearest rotation (in the Frobenius norm) put back into `t`; use after long products.
Transform orthonormalised(const Transform& t);

}  // namespace isthmus
