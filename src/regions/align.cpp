#include "regions/align.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "regions/lookups.h"

namespace isthmus {

namespace {

// Calls f(p in the target's frame, normal, distance along it, source point, target point) for every point of the sample
// that faces a plane of the target closer than the gate.
template <class F>
void for_each_faced_plane(const ScanModel& source, const ScanModel& target, const Transform& target_from_source,
                          std::span<const std::uint32_t> sample, const SurfaceLookup& lookup, float gate_m, F&& f) {
  constexpr float kMinFacing = 0.5f;
  const Pose3f pose = pose3f(target_from_source);
  for_each_lookup(source, target, lookup, pose, sample, [&](std::size_t k, const Eigen::Vector3f& p, std::int32_t j) {
    if (j < 0 || target.variation[j] >= 1.0f) return;
    const Eigen::Vector3f& n = target.normals[j];
    if (n.dot(pose.rotation * source.normals[sample[k]]) < kMinFacing) return;
    const float r = n.dot(p - target.points[j]);
    if (r * r < gate_m * gate_m) f(p, n, r, sample[k], static_cast<std::uint32_t>(j));
  });
}

// Inverse variance of a residual, 1 between flat surfaces. At the far end of the ground kerbs, grass and wheels share a
// voxel with it and lift it: weighed like the clean ground near the station, they bend a street into a bowl.
float certainty(float variation, float other_variation) {
  constexpr float kFlatVoxels = 0.07f, kRoughVoxels = 1.2f;  // what flat surfaces leave; times sqrt(variation)
  constexpr float kRatio = kRoughVoxels / kFlatVoxels;
  return 1 / (1 + kRatio * kRatio * (variation + other_variation));
}

}  // namespace

void add_point_to_plane(const ScanModel& source, const ScanModel& target, const Transform& target_from_source,
                        std::span<const std::uint32_t> sample, bool coarse, float gate_m, const Eigen::Vector3d& centre,
                        NormalEquations& equations, MatchWeights weights) {
  const Eigen::Vector3f middle = centre.cast<float>();
  Eigen::Matrix<float, 6, 6> a = Eigen::Matrix<float, 6, 6>::Zero();
  Eigen::Matrix<float, 6, 1> b = Eigen::Matrix<float, 6, 1>::Zero();
  for_each_faced_plane(
      source, target, target_from_source, sample, coarse ? target.coarse : target.fine, gate_m,
      [&](const Eigen::Vector3f& p, const Eigen::Vector3f& n, float r, std::uint32_t i, std::uint32_t j) {
        const float ratio = r / gate_m;
        float w = (1 - ratio * ratio) * (1 - ratio * ratio);
        if (weights == MatchWeights::by_roughness) w *= certainty(source.variation[i], target.variation[j]);
        Eigen::Matrix<float, 6, 1> j6;
        j6 << n, (p - middle).cross(n);
        a.noalias() += w * j6 * j6.transpose();
        b.noalias() -= w * r * j6;
        equations.weight += w;
        equations.sq_residual_sum += static_cast<double>(w * r * r);
        ++equations.matches;
      });
  equations.a += a.cast<double>();
  equations.b += b.cast<double>();
}

double observability(const NormalEquations& equations) {
  const Eigen::Vector3d stiffness =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(equations.a.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly)
          .eigenvalues();
  return stiffness[2] > 0 ? std::max(0.0, stiffness[0]) / stiffness[2] : 0;
}

bool flat_surfaces_hold(const NormalEquations& by_roughness, const NormalEquations& alike) {
  constexpr double kAboutAsWell = 0.5, kLeastWeight = 0.15;
  return by_roughness.weight >= kLeastWeight * alike.weight &&
         observability(by_roughness) >= kAboutAsWell * observability(alike);
}

std::vector<float> distances_to_planes(const ScanModel& source, const ScanModel& target,
                                       const Transform& target_from_source, std::span<const std::uint32_t> sample,
                                       float gate_m) {
  std::vector<float> distances;
  for_each_faced_plane(source, target, target_from_source, sample, target.fine, gate_m,
                       [&](const Eigen::Vector3f&, const Eigen::Vector3f&, float r, std::uint32_t, std::uint32_t) {
                         distances.push_back(std::abs(r));
                       });
  return distances;
}

Transform solved_step(const NormalEquations& equations, const Eigen::Vector3d& centre, double voxel_m,
                      const StepLimit& limit) {
  constexpr double kDamping = 1e-3;  // of the average stiffness: unobserved directions stay
  Matrix6d a = equations.a;
  const double translation = a.topLeftCorner<3, 3>().trace() / 3, rotation = a.bottomRightCorner<3, 3>().trace() / 3;
  for (int k = 0; k < 3; ++k) {
    a(k, k) += kDamping * translation + 1e-12;
    a(k + 3, k + 3) += kDamping * rotation + 1e-12 * voxel_m * voxel_m;
  }
  Vector6d x = a.ldlt().solve(equations.b);
  Transform step = Transform::Identity();
  if (!x.allFinite()) return step;
  const double excess = std::max(x.head<3>().norm() / limit.translation_m, x.tail<3>().norm() / limit.rotation_rad);
  if (excess > 1) x /= excess;
  const Eigen::Matrix3d turn = rotation_from_vector(x.tail<3>());
  step.linear() = turn;
  step.translation() = centre + x.head<3>() - turn * centre;
  return step;
}

}  // namespace isthmus
