#include "congruent/refine.h"

#include <Eigen/Cholesky>

namespace isthmus::congruent {
namespace {

constexpr int kFewestPoints = 6;
constexpr double kStandstill = 1e-5;  // of the target's half diameter
constexpr double kDamping = 1e-3;     // of the mean diagonal: holds what the surface leaves open, hardly slows the rest

// Normal equations of one step for the motion x -> x + w x (x - centre) + t, unknowns (t, w).
struct NormalEquations {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  int num_points = 0;

  void add(const Eigen::Vector3d& arm, const Eigen::Vector3d& direction, double residual_m) {
    Vector6d row;
    row << direction, arm.cross(direction);
    matrix += row * row.transpose();
    right += residual_m * row;
  }
};

NormalEquations linearised(const FacingGrid& grid, const LocalCloud& target, const ScoreSample& sample,
                           const Transform& target_from_source, double scale_m) {
  NormalEquations equations;
  const Eigen::Matrix3f rotation = target_from_source.linear().cast<float>();
  const bool oriented = !target.normals.empty();
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    const Eigen::Vector3d moved = target_from_source * sample.points[i].cast<double>();
    const Eigen::Vector3f normal =
        sample.normals.empty() ? Eigen::Vector3f::Zero().eval() : (rotation * sample.normals[i]).eval();
    const auto nearest = grid.nearest_facing(moved.cast<float>(), normal);
    if (!nearest) continue;
    ++equations.num_points;
    const Eigen::Vector3d to_target = target.points[*nearest].cast<double>() - moved;
    const Eigen::Vector3d arm = (moved - target_from_source.translation()) / scale_m;
    if (oriented) {
      const Eigen::Vector3d n = target.normals[*nearest].cast<double>();
      equations.add(arm, n, n.dot(to_target));
    } else {
      for (int axis = 0; axis < 3; ++axis) equations.add(arm, Eigen::Vector3d::Unit(axis), to_target[axis]);
    }
  }
  return equations;
}

}  // namespace

Transform refined(const FacingGrid& grid, const LocalCloud& target, const ScoreSample& sample,
                  const Transform& target_from_source, int steps) {
  // The sample is centred near its origin, so the source's origin is the centre of rotation; lengths are scaled to
  // about one so that damping weighs metres and radians alike.
  const double scale_m = target.diameter_m > 0 ? 0.5 * target.diameter_m : 1.0;
  Transform current = target_from_source;
  for (int step = 0; step < steps; ++step) {
    NormalEquations equations = linearised(grid, target, sample, current, scale_m);
    if (equations.num_points < kFewestPoints) break;
    equations.matrix.diagonal().array() += kDamping * equations.matrix.trace() / 6;
    const Vector6d motion = equations.matrix.ldlt().solve(equations.right);
    if (!motion.allFinite() || motion.norm() < kStandstill * scale_m) break;
    const Eigen::Vector3d centre = current.translation();
    current.linear() = rotation_from_vector(motion.tail<3>() / scale_m) * current.linear();
    current.translation() = centre + motion.head<3>();
    current = orthonormalised(current);
  }
  return current;
}

}  // namespace isthmus::congruent
