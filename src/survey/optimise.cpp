#include "survey/optimise.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <algorithm>
#include <array>
#include <cmath>

namespace isthmus::survey {
namespace {

// Yang et al. 2020 divide (for TLS: multiply) the control parameter by 1.4 per step.
constexpr double kGncFactor = 1.4;
constexpr int kMaxGncSteps = 100;
// Weights within this of 0 or 1 count as decided.
constexpr double kDecided = 1e-3;
constexpr int kMaxIterations = 100;
constexpr double kRelativeTolerance = 1e-12;

template <class T>
Eigen::Matrix<T, 3, 1> rotation_vector(const Eigen::Quaternion<T>& turn) {
  const T wxyz[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  Eigen::Matrix<T, 3, 1> vector;
  ceres::QuaternionToAngleAxis(wxyz, vector.data());
  return vector;
}

/// Residual W (translation; rotation vector) of measured^-1 * target_from_source, quaternions x y z w.
struct LinkResidual {
  Eigen::Quaterniond measured_rotation;
  Eigen::Vector3d measured_translation;
  Matrix6d whitening;

  template <class T>
  bool operator()(const T* t_target, const T* q_target, const T* t_source, const T* q_source, T* out) const {
    using V = Eigen::Matrix<T, 3, 1>;
    using Q = Eigen::Quaternion<T>;
    const Eigen::Map<const V> translation_target(t_target), translation_source(t_source);
    const Eigen::Map<const Q> rotation_target(q_target), rotation_source(q_source);
    const Q target_from_root = rotation_target.conjugate();
    const V translation = target_from_root * (translation_source - translation_target);
    const Q rotation = target_from_root * rotation_source;
    const Q measured_inverse = measured_rotation.conjugate().template cast<T>();
    Eigen::Matrix<T, 6, 1> d;
    d.template head<3>() = measured_inverse * (translation - measured_translation.template cast<T>());
    d.template tail<3>() = rotation_vector<T>(measured_inverse * rotation);
    Eigen::Map<Eigen::Matrix<T, 6, 1>> residual(out);
    residual = whitening.template cast<T>() * d;
    return true;
  }
};

struct Pose {
  std::array<double, 3> t;
  std::array<double, 4> q;  // x y z w
};

std::vector<Pose> poses_of(const std::vector<Transform>& transforms) {
  std::vector<Pose> poses;
  for (const Transform& t : transforms) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(t.linear()).normalized();
    poses.push_back({{t.translation().x(), t.translation().y(), t.translation().z()}, {q.x(), q.y(), q.z(), q.w()}});
  }
  return poses;
}

Transform transform_of(const Pose& pose) {
  Transform t = Transform::Identity();
  t.linear() = Eigen::Quaterniond(pose.q[3], pose.q[0], pose.q[1], pose.q[2]).normalized().toRotationMatrix();
  t.translation() = Eigen::Vector3d(pose.t[0], pose.t[1], pose.t[2]);
  return t;
}

ceres::Solver::Options ceres_options() {
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = kRelativeTolerance;
  options.parameter_tolerance = kRelativeTolerance;
  options.gradient_tolerance = kRelativeTolerance;
  options.logging_type = ceres::SILENT;
  // Eigen's own factorisation: the packaged SuiteSparse calls a BLAS whose threads would show in the last digits.
  if (ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::EIGEN_SPARSE)) {
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  } else {
    options.linear_solver_type = ceres::DENSE_QR;
  }
  return options;
}

/// Whitened position of a point against the known one.
struct PointResidual {
  ControlTerm term;

  template <class T>
  bool operator()(const T* t, const T* q, T* out) const {
    using V = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const V> translation(t);
    const Eigen::Map<const Eigen::Quaternion<T>> rotation(q);
    const V p = rotation * term.p_in_node.cast<T>() + translation - term.p_in_shifted.cast<T>();
    for (int k = 0; k < 3; ++k) out[k] = p[k] / term.sigma_m[k];
    return true;
  }
};

/// Whitened tilts of a level scan.
struct LevelResidual {
  double sigma_rad;

  template <class T>
  bool operator()(const T* q, T* out) const {
    const Eigen::Map<const Eigen::Quaternion<T>> rotation(q);
    const Eigen::Matrix<T, 3, 1> up = rotation * Eigen::Matrix<T, 3, 1>(T(0), T(0), T(1));
    out[0] = up[0] / sigma_rad;
    out[1] = up[1] / sigma_rad;
    return true;
  }
};

/// Whitened distance from a known pose.
struct PoseResidual {
  ControlTerm term;

  template <class T>
  bool operator()(const T* t, const T* q, T* out) const {
    using V = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const V> translation(t);
    const Eigen::Map<const Eigen::Quaternion<T>> rotation(q);
    const V off = translation - term.shifted_from_node.translation().cast<T>();
    const V turn =
        rotation_vector<T>(Eigen::Quaterniond(term.shifted_from_node.linear()).conjugate().cast<T>() * rotation);
    for (int k = 0; k < 3; ++k) {
      out[k] = off[k] / term.sigma_m[k];
      out[3 + k] = turn[k] / term.sigma_rad;
    }
    return true;
  }
};

/// Keeps the heading: an axis of the scan that is level at the start does not turn about the vertical.
struct HeadingResidual {
  Eigen::Vector3d axis_in_node, across;

  template <class T>
  bool operator()(const T* q, T* out) const {
    constexpr double kSigmaRad = 1e-6;  // far below what any scan tells
    const Eigen::Map<const Eigen::Quaternion<T>> rotation(q);
    const Eigen::Matrix<T, 3, 1> turned = rotation * axis_in_node.cast<T>();
    out[0] = turned.dot(across.cast<T>()) / kSigmaRad;
    return true;
  }
};

void add_term(ceres::Problem& problem, const ControlTerm& term, Pose& pose) {
  if (term.kind == ControlKind::point) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PointResidual, 3, 3, 4>(new PointResidual{term}), nullptr,
                             pose.t.data(), pose.q.data());
  } else if (term.kind == ControlKind::pose) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PoseResidual, 6, 3, 4>(new PoseResidual{term}), nullptr,
                             pose.t.data(), pose.q.data());
  } else {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<LevelResidual, 2, 4>(new LevelResidual{term.sigma_rad}),
                             nullptr, pose.q.data());
  }
}

void hold_place_and_heading(ceres::Problem& problem, Pose& pose) {
  problem.SetParameterBlockConstant(pose.t.data());
  const Eigen::Quaterniond q(pose.q[3], pose.q[0], pose.q[1], pose.q[2]);
  const Eigen::Vector3d ahead = q.inverse() * Eigen::Vector3d::UnitX();
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<HeadingResidual, 1, 4>(new HeadingResidual{ahead, Eigen::Vector3d::UnitY()}),
      nullptr, pose.q.data());
}

void add_link(ceres::Problem& problem, const Measurement& m, double weight, std::vector<Pose>& poses) {
  const Transform& measured = m.target_from_source.b_from_a;
  auto* cost = new ceres::AutoDiffCostFunction<LinkResidual, 6, 3, 4, 3, 4>(
      new LinkResidual{Eigen::Quaterniond(measured.linear()).normalized(), measured.translation(),
                       std::sqrt(weight) * m.sqrt_information});
  Pose& target = poses[m.target];
  Pose& source = poses[m.source];
  problem.AddResidualBlock(cost, nullptr, target.t.data(), target.q.data(), source.t.data(), source.q.data());
}

void add_pose(ceres::Problem& problem, Pose& pose, ceres::Manifold* manifold) {
  problem.AddParameterBlock(pose.t.data(), 3);
  problem.AddParameterBlock(pose.q.data(), 4, manifold);
}

/// Least squares; the text is empty when the optimiser is content.
std::string solved(ceres::Problem& problem) {
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options(), &problem, &summary);
  return summary.IsSolutionUsable() ? std::string() : summary.BriefReport();
}

/// One weighted least-squares solve; the text is empty when the optimiser is content.
std::string solve_weighted(std::vector<Pose>& poses, std::span<const Measurement> measurements,
                           const std::vector<double>& weights, const std::vector<int>& fixed) {
  ceres::Problem problem;
  ceres::EigenQuaternionManifold* const manifold = new ceres::EigenQuaternionManifold;  // owned by the problem
  for (Pose& pose : poses) add_pose(problem, pose, manifold);
  for (std::size_t e = 0; e < measurements.size(); ++e)
    if (weights[e] > 0) add_link(problem, measurements[e], weights[e], poses);
  for (const int node : fixed) {
    problem.SetParameterBlockConstant(poses[node].t.data());
    problem.SetParameterBlockConstant(poses[node].q.data());
  }
  return solved(problem);
}

std::vector<double> chi2_of_all(const std::vector<Pose>& poses, std::span<const Measurement> measurements) {
  std::vector<Transform> transforms;
  for (const Pose& pose : poses) transforms.push_back(transform_of(pose));
  std::vector<double> chi2;
  for (const Measurement& m : measurements) chi2.push_back(chi2_at(m, transforms));
  return chi2;
}

/// Weight of a residual under the TLS surrogate with control parameter mu (Yang et al. 2020, the closed-form update for
/// TLS).
double tls_weight(double chi2, double limit, double mu) {
  if (chi2 <= mu / (mu + 1.0) * limit) return 1.0;
  if (chi2 >= (mu + 1.0) / mu * limit) return 0.0;
  return std::sqrt(limit * mu * (mu + 1.0) / chi2) - mu;
}

bool decided(const std::vector<double>& weights) {
  return std::all_of(weights.begin(), weights.end(), [](double w) { return w < kDecided || w > 1.0 - kDecided; });
}

}  // namespace

double chi2_at(const Measurement& m, const std::vector<Transform>& root_from_node) {
  const Transform predicted = root_from_node[m.target].inverse() * root_from_node[m.source];
  return (m.sqrt_information * disagreement(m.target_from_source.b_from_a, predicted)).squaredNorm();
}

OptimisedPoses optimise(std::vector<Transform> root_from_node, std::span<const Measurement> measurements,
                        const std::vector<int>& fixed, double chi2_limit) {
  std::vector<Pose> poses = poses_of(root_from_node);
  OptimisedPoses out;
  out.weights.assign(measurements.size(), 1.0);
  if (!measurements.empty()) out.problem = solve_weighted(poses, measurements, out.weights, fixed);
  std::vector<double> chi2 = chi2_of_all(poses, measurements);
  double mu = 0;  // below the limit everywhere the plain solution is the truncated one: nothing is truncated
  if (!chi2.empty() && *std::max_element(chi2.begin(), chi2.end()) > chi2_limit) {
    // Where we differ from Yang et al., who start from the unweighted solution: wild links can drag its rotations so
    // far that no reweighting finds back. The given poses come from the tree that the loops agree with.
    poses = poses_of(root_from_node);
    chi2 = chi2_of_all(poses, measurements);
    const double largest = std::max(chi2_limit, *std::max_element(chi2.begin(), chi2.end()));
    mu = chi2_limit / (2.0 * largest - chi2_limit);
  }
  for (int step = 0; mu > 0 && step < kMaxGncSteps; ++step, mu *= kGncFactor) {
    for (std::size_t e = 0; e < chi2.size(); ++e) out.weights[e] = tls_weight(chi2[e], chi2_limit, mu);
    out.problem = solve_weighted(poses, measurements, out.weights, fixed);
    chi2 = chi2_of_all(poses, measurements);
    if (step > 0 && decided(out.weights)) break;
  }
  for (double& w : out.weights) w = w < 0.5 ? 0.0 : 1.0;
  if (mu > 0) out.problem = solve_weighted(poses, measurements, out.weights, fixed);
  for (std::size_t i = 0; i < poses.size(); ++i) root_from_node[i] = transform_of(poses[i]);
  out.root_from_node = std::move(root_from_node);
  return out;
}

OptimisedPoses optimise_by_precision(std::vector<Transform> root_from_node, std::span<const Measurement> measurements,
                                     const std::vector<int>& fixed) {
  constexpr double kDimension = 6, kFreedom = 4;  // degrees of freedom of the t distribution
  constexpr double kPrior = 12;                   // observations that the pair stage's own scale counts for
  constexpr int kMaxSteps = 20;
  constexpr double kStill = 1e-3;  // of the scale
  std::vector<Measurement> own(measurements.begin(), measurements.end());
  for (Measurement& m : own) m.sqrt_information = m.own_sqrt_information;
  std::vector<Pose> poses = poses_of(root_from_node);
  OptimisedPoses out;
  std::vector<double> weights(own.size(), 1.0);
  const auto redundant =
      static_cast<double>(own.size()) - static_cast<double>(poses.size()) + static_cast<double>(fixed.size());
  double scale = 1;
  for (int step = 0; step < kMaxSteps && !own.empty(); ++step) {
    out.problem = solve_weighted(poses, own, weights, fixed);
    const std::vector<double> chi2 = chi2_of_all(poses, own);
    double sum = 0;
    for (std::size_t e = 0; e < own.size(); ++e) {
      weights[e] = (kFreedom + kDimension) / (kFreedom + chi2[e] / scale);
      sum += weights[e] * chi2[e];
    }
    const double before = scale;
    scale = (kPrior + sum) / (kPrior + kDimension * redundant);
    if (std::abs(scale - before) < kStill * before) break;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) root_from_node[i] = transform_of(poses[i]);
  out.root_from_node = std::move(root_from_node);
  for (double& w : weights) w /= scale;
  out.weights = std::move(weights);
  out.variance_factor = scale;
  return out;
}

OptimisedPoses optimise_with_control(std::vector<Transform> shifted_from_node,
                                     std::span<const Measurement> measurements, std::span<const ControlTerm> terms,
                                     int held) {
  std::vector<Pose> poses = poses_of(shifted_from_node);
  ceres::Problem problem;
  ceres::EigenQuaternionManifold* const manifold = new ceres::EigenQuaternionManifold;  // owned by the problem
  std::vector<char> touched(poses.size(), 0);
  for (const Measurement& m : measurements) touched[m.source] = touched[m.target] = 1;
  for (const ControlTerm& term : terms) touched[term.node] = 1;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (touched[i]) add_pose(problem, poses[i], manifold);
  for (const Measurement& m : measurements) add_link(problem, m, 1.0, poses);
  for (const ControlTerm& term : terms) add_term(problem, term, poses[term.node]);
  if (held >= 0) hold_place_and_heading(problem, poses[held]);
  OptimisedPoses out;
  out.problem = solved(problem);
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (touched[i]) shifted_from_node[i] = transform_of(poses[i]);
  out.root_from_node = std::move(shifted_from_node);
  return out;
}

}  // namespace isthmus::survey
