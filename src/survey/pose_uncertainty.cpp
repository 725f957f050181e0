#include "survey/pose_uncertainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isthmus::survey {
namespace {

double largest_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

}  // namespace

std::vector<std::optional<PoseSigma>> pose_sigmas(const std::vector<Transform>& root_from_node,
                                                  std::span<const Measurement> measurements,
                                                  const std::vector<int>& fixed) {
  std::vector<int> slot(root_from_node.size(), -1);
  int num_free = 0;
  std::vector<char> touched(root_from_node.size(), 0);
  for (const Measurement& m : measurements) touched[m.source] = touched[m.target] = 1;
  for (const int node : fixed) touched[node] = 0;
  for (std::size_t i = 0; i < slot.size(); ++i)
    if (touched[i]) slot[i] = num_free++;
  std::vector<std::optional<PoseSigma>> out(root_from_node.size());
  if (num_free == 0) return out;

  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(6 * num_free, 6 * num_free);
  for (const Measurement& m : measurements) {
    // Residual d of measured^-1 T_t^-1 T_s under right perturbations of the poses: to first order at the solution
    // d += d_s - Ad(T_s^-1 T_t) d_t.
    const Matrix6d js = m.sqrt_information;
    const Matrix6d jt = -js * adjoint(root_from_node[m.source].inverse() * root_from_node[m.target]);
    const int s = slot[m.source], t = slot[m.target];
    if (s >= 0) normal.block<6, 6>(6 * s, 6 * s) += js.transpose() * js;
    if (t >= 0) normal.block<6, 6>(6 * t, 6 * t) += jt.transpose() * jt;
    if (s >= 0 && t >= 0) {
      normal.block<6, 6>(6 * s, 6 * t) += js.transpose() * jt;
      normal.block<6, 6>(6 * t, 6 * s) += jt.transpose() * js;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(normal);
  if (factor.info() != Eigen::Success) return out;
  const Eigen::MatrixXd covariance = factor.solve(Eigen::MatrixXd::Identity(6 * num_free, 6 * num_free));
  for (std::size_t i = 0; i < slot.size(); ++i) {
    if (slot[i] < 0) continue;
    const Matrix6d c = covariance.block<6, 6>(6 * slot[i], 6 * slot[i]);
    out[i] = PoseSigma{largest_sigma(c.topLeftCorner<3, 3>()), largest_sigma(c.bottomRightCorner<3, 3>()), c};
  }
  return out;
}

}  // namespace isthmus::survey
