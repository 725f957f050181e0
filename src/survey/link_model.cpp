#include "survey/link_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "pairwise/judge.h"

namespace isthmus::survey {
namespace {

// A direction in which a link says nothing is still known to this many voxels and radians: wide enough never to judge,
// narrow enough to keep every matrix regular.
constexpr double kCeilingVoxels = 100.0;
constexpr double kCeilingRad = 0.5;
constexpr double kTightFloors = 4.0;  // two voxels with the default noise: surfaces within it meet
// Two surfaces that were sampled differently meet to a hundredth of a voxel at best (docs/stages/verdict.md).
constexpr double kOwnFloor = 0.02;
// How far a rotation part may be from orthonormal before the measurement counts as broken rather than rounded.
constexpr double kRotationTolerance = 1e-6;

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Vector6d by_kind(double translation, double rotation) {
  Vector6d v;
  v << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation);
  return v;
}

Matrix6d sqrt_information_of(const Matrix6d& covariance) {
  return Matrix6d(Matrix6d(covariance.inverse()).llt().matrixL()).transpose();
}

/// Covariance of a symmetric, possibly singular information: the ceiling is a weak prior, the floor is added noise.
Matrix6d covariance_of(const Matrix6d& information, const NoiseModel& noise) {
  const Vector6d prior = by_kind(noise.ceiling_m, noise.ceiling_rad).array().square().inverse();
  const Vector6d scale = prior.cwiseSqrt();  // metres and radians become comparable before the eigenvalues are judged
  const Matrix6d unitless = scale.cwiseInverse().asDiagonal() * information * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(unitless);
  const Vector6d variance = (eigen.eigenvalues().cwiseMax(0.0).array() + 1.0).inverse();
  Matrix6d covariance = eigen.eigenvectors() * variance.asDiagonal() * eigen.eigenvectors().transpose();
  covariance = (scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal()).eval();
  covariance.diagonal() += by_kind(noise.floor_m, noise.floor_rad).cwiseAbs2();
  return covariance;
}

}  // namespace

Matrix6d adjoint(const Transform& t) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = t.linear();
  m.bottomRightCorner<3, 3>() = t.linear();
  m.topRightCorner<3, 3>() = skew(t.translation()) * t.linear();
  return m;
}

Relative compose(const Relative& c_from_b, const Relative& b_from_a) {
  const Matrix6d ad = adjoint(b_from_a.b_from_a.inverse());
  return {c_from_b.b_from_a * b_from_a.b_from_a, ad * c_from_b.covariance * ad.transpose() + b_from_a.covariance};
}

Relative inverse(const Relative& b_from_a) {
  const Matrix6d ad = adjoint(b_from_a.b_from_a);
  return {b_from_a.b_from_a.inverse(), ad * b_from_a.covariance * ad.transpose()};
}

Vector6d disagreement(const Transform& measured, const Transform& predicted) {
  const Transform delta = measured.inverse() * predicted;
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(delta.linear()).normalized());
  const double angle = turn.angle() > std::numbers::pi ? turn.angle() - 2.0 * std::numbers::pi : turn.angle();
  Vector6d d;
  d << delta.translation(), angle * turn.axis();
  return d;
}

double floors_of(const Vector6d& d, const Measurement& m) {
  return std::max(d.head<3>().norm() / m.floor_m, d.tail<3>().norm() / m.floor_rad);
}

bool is_tight(const Vector6d& d, const Measurement& m) { return floors_of(d, m) <= kTightFloors; }

double chi2_of(const Vector6d& d, const Matrix6d& covariance) { return d.dot(covariance.ldlt().solve(d)); }

NoiseModel noise_model(const PoseGraph& graph, const GraphScan& source, const SolveOptions& options) {
  NoiseModel noise;
  noise.floor_m = options.noise_voxels * graph.voxel_m;
  noise.floor_rad =
      source.radius_m > 0 ? noise.floor_m / source.radius_m : options.noise_deg * std::numbers::pi / 180.0;
  noise.ceiling_m = kCeilingVoxels * graph.voxel_m;
  noise.ceiling_rad = kCeilingRad;
  return noise;
}

double clipped_log_odds(double probability) {
  const double p = std::clamp(probability, 0.01, 0.9999);
  return std::log(p / (1.0 - p));
}

double probability_of(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

MeasurementOrReason measurement_of(const Link& link, const GraphScan& source, const GraphScan& target,
                                   const NoiseModel& noise) {
  const auto unusable = [](std::string why) { return MeasurementOrReason{{}, std::move(why)}; };
  const PairResult& r = link.result;
  if (!r.target_from_source) return unusable("has no transform");
  if (!r.target_from_source->matrix().allFinite() || !r.information.allFinite())
    return unusable("its transform or information holds a value that is not finite");
  const Eigen::Matrix3d rotation = r.target_from_source->linear();
  const double skewness = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (skewness > kRotationTolerance || rotation.determinant() < 0)
    return unusable(fmt::format("its rotation is not orthonormal (off by {:.2g})", skewness));

  Measurement m;
  m.log_odds = link.guided ? 0.0 : clipped_log_odds(r.probability);
  m.accepted = r.verdict == Verdict::accepted;
  m.votes = !link.guided && !forbidden_by_free_space(r);
  m.floor_m = noise.floor_m;
  m.floor_rad = noise.floor_rad;
  m.overlap = r.overlap;
  const Transform local_from_centred(Eigen::Translation3d(source.centre));
  m.target_from_source.b_from_a = Eigen::Translation3d(-target.centre) * *r.target_from_source * local_from_centred;
  // d_local = Ad(centre) d_centred, so information_centred = Ad' information Ad.
  const Matrix6d ad = adjoint(local_from_centred);
  const Matrix6d symmetric = 0.5 * (r.information + r.information.transpose());
  const Matrix6d own = ad.transpose() * symmetric * ad;
  m.target_from_source.covariance = covariance_of(own, noise);
  m.sqrt_information = sqrt_information_of(m.target_from_source.covariance);
  NoiseModel least = noise;
  least.floor_m *= kOwnFloor, least.floor_rad *= kOwnFloor;
  m.own_sqrt_information = sqrt_information_of(covariance_of(own, least));
  return {m, {}};
}

}  // namespace isthmus::survey
