#include "scan/thinning.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {
namespace {

// Weighted sums over a neighbourhood, about a point in its midst.
struct Neighbourhood {
  float weight = 0;
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();

  void add(const CountedPoints& points, std::uint32_t j, const Eigen::Vector3f& about, float kernel) {
    const float w = kernel * static_cast<float>(points.counts[j]);
    const Eigen::Vector3f d = points.means[j] - about;
    weight += w, first += w * d, second += w * (d * d.transpose());
    if (!points.covariances.empty()) second += w * points.covariances[j];
  }
  [[nodiscard]] Eigen::Vector3f mean() const { return first / weight; }
  [[nodiscard]] Eigen::Matrix3f covariance() const { return second / weight - mean() * mean().transpose(); }
};

}  // namespace

double noise_m(const CountedPoints& points, double smallest_m, double largest_m) {
  constexpr std::size_t kPlaces = 500;
  constexpr double kGrowth = 1.4;
  constexpr float kFlat = 0.08f, kMinRawPoints = 30;
  constexpr std::size_t kMinNeighbours = 4;
  constexpr double kMinFlatShare = 0.1;
  const PointGrid grid(points.means, static_cast<float>(2 * smallest_m));
  const std::size_t step = std::max<std::size_t>(1, points.means.size() / kPlaces);
  std::vector<float> deviations;
  std::size_t places = 0;
  for (std::size_t i = 0; i < points.means.size(); i += step) {
    ++places;
    for (double radius = smallest_m; radius < largest_m; radius *= kGrowth) {
      Neighbourhood near;
      std::size_t n = 0;
      grid.for_each_within(points.means[i], static_cast<float>(radius), [&](std::uint32_t j, float) {
        near.add(points, j, points.means[i], 1.0f);
        ++n;
      });
      if (near.weight < kMinRawPoints || n < kMinNeighbours) continue;
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
      solver.computeDirect(near.covariance(), Eigen::EigenvaluesOnly);
      const float smallest = std::max(0.0f, solver.eigenvalues()[0]);
      if (smallest >= kFlat * solver.eigenvalues().sum()) continue;
      deviations.push_back(std::sqrt(smallest));
      break;
    }
  }
  if (deviations.empty() || static_cast<double>(deviations.size()) < kMinFlatShare * static_cast<double>(places))
    return 0;
  std::sort(deviations.begin(), deviations.end());
  return static_cast<double>(deviations[deviations.size() / 2]);
}

std::vector<RidgePoint> thinned(std::span<const Eigen::Vector3f> points, const CountedPoints& cloud, double noise_m) {
  constexpr float kKernelDeviations = 2, kReachKernels = 2.2f;
  constexpr int kSteps = 4;
  constexpr std::size_t kMinNeighbours = 4;
  const float kernel_m = kKernelDeviations * static_cast<float>(noise_m), radius_m = kReachKernels * kernel_m;
  const PointGrid grid(cloud.means, radius_m);
  std::vector<RidgePoint> out(points.size());
  parallel_for_index(points.size(), 64, [&](std::size_t i) {
    RidgePoint ridge{points[i], Eigen::Vector3f::Zero()};
    for (int step = 0; step < kSteps; ++step) {
      Neighbourhood near;
      std::size_t n = 0;
      grid.for_each_within(ridge.point, radius_m, [&](std::uint32_t j, float sq_distance) {
        near.add(cloud, j, ridge.point, std::exp(-0.5f * sq_distance / (kernel_m * kernel_m)));
        ++n;
      });
      if (n < kMinNeighbours) break;
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
      solver.computeDirect(near.covariance());
      const Eigen::Vector3f normal = solver.eigenvectors().col(0).normalized();
      if (!normal.allFinite()) break;
      ridge.normal = normal;
      ridge.point += normal * normal.dot(near.mean());
    }
    out[i] = ridge;
  });
  return out;
}

}  // namespace isthmus
