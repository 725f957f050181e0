#include "geometry/transform.h"

#include <Eigen/SVD>
#include <cmath>

namespace isthmus {

double rotation_angle_rad(const Eigen::Matrix3d& r) {
  const Eigen::Vector3d twice_sine_axis(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(twice_sine_axis.norm(), r.trace() - 1.0);
}

double displacement_m(const Transform& a, const Transform& b, const Eigen::Vector3d& p_in_source) {
  return (a * p_in_source - b * p_in_source).norm();
}

Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

Transform orthonormalised(const Transform& t) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(t.linear(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);  // the smallest singular value pays
  Transform out = t;
  out.linear() = u * svd.matrixV().transpose();
  return out;
}

}  // namespace isthmus
