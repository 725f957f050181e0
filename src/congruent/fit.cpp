#include "congruent/fit.h"

#include <Eigen/SVD>
#include <cmath>

namespace isthmus::congruent {
namespace {

constexpr double kFlattestSpread = 1e-6;  // second singular value against the first: below, the points are a line

Eigen::Vector3d mean(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

using Corners = std::array<Eigen::Vector3d, 4>;

// Orthonormal axes from the diagonals: x bisects them, z is normal to both.
Eigen::Matrix3d diagonal_frame(const Corners& abcd) {
  const Eigen::Vector3d u = (abcd[1] - abcd[0]).normalized(), v = (abcd[3] - abcd[2]).normalized();
  Eigen::Matrix3d frame;
  frame.col(0) = (u + v).normalized();
  frame.col(2) = u.cross(v).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

}  // namespace

std::optional<RigidFit> fit_rigid(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target) {
  if (source.size() < 3 || source.size() != target.size()) return std::nullopt;
  const Eigen::Vector3d source_mean = mean(source), target_mean = mean(target);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i)
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose();
  if (!covariance.allFinite()) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& spread = svd.singularValues();
  if (!(spread[1] > kFlattestSpread * spread[0])) return std::nullopt;

  Eigen::Matrix3d u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) *= -1;
  RigidFit fit;
  fit.target_from_source.linear() = u * svd.matrixV().transpose();
  fit.target_from_source.translation() = target_mean - fit.target_from_source.linear() * source_mean;
  double sq_sum = 0;
  for (std::size_t i = 0; i < source.size(); ++i)
    sq_sum += (fit.target_from_source * source[i] - target[i]).squaredNorm();
  fit.rms_m = std::sqrt(sq_sum / static_cast<double>(source.size()));
  return fit;
}

DiagonalFit::DiagonalFit(const Corners& source_abcd)
    : source_from_frame_(diagonal_frame(source_abcd)), source_middle_(mean(source_abcd)) {}

Transform DiagonalFit::operator()(const Corners& target_abcd) const {
  Transform pose = Transform::Identity();
  pose.linear() = diagonal_frame(target_abcd) * source_from_frame_.transpose();
  pose.translation() = mean(target_abcd) - pose.linear() * source_middle_;
  return pose;
}

}  // namespace isthmus::congruent
