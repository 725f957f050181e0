#include "features/iss.h"

#include <Eigen/Eigenvalues>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {

std::vector<float> iss_saliency(std::span<const Eigen::Vector3f> points, float radius_m, float non_max_radius_m,
                                float gamma) {
  constexpr int kMinNeighbours = 5;
  const PointGrid grid(points, radius_m);
  std::vector<float> third(points.size(), 0);
  parallel_for_index(points.size(), 128, [&](std::size_t i) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    int n = 0;
    grid.for_each_within(points[i], radius_m, [&](std::uint32_t j, float) {
      const Eigen::Vector3d d = (points[j] - points[i]).cast<double>();
      scatter += d * d.transpose();
      ++n;
    });
    if (n - 1 < kMinNeighbours) return;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(scatter / n, Eigen::EigenvaluesOnly);
    const Eigen::Vector3d l = solver.eigenvalues();  // ascending
    if (l[0] > 0 && l[1] < gamma * l[2] && l[0] < gamma * l[1]) third[i] = static_cast<float>(l[0]);
  });
  std::vector<float> saliency(points.size(), 0);
  const PointGrid near(points, non_max_radius_m);
  parallel_for_index(points.size(), 128, [&](std::size_t i) {
    if (third[i] <= 0) return;
    bool largest = true;
    near.for_each_within(points[i], non_max_radius_m, [&](std::uint32_t j, float) {
      if (third[j] > third[i] || (third[j] == third[i] && j < i)) largest = false;
    });
    if (largest) saliency[i] = third[i];
  });
  return saliency;
}

}  // namespace isthmus
