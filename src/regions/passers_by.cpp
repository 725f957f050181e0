#include "regions/passers_by.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "geometry/point_grid.h"

namespace isthmus {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// Groups of points that hang together over gaps of up to `reach_m`, as indices.
std::vector<std::vector<std::uint32_t>> groups_of(const Points& points, float reach_m) {
  const PointGrid grid(points, reach_m);
  std::vector<bool> seen(points.size(), false);
  std::vector<std::vector<std::uint32_t>> groups;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (seen[i]) continue;
    seen[i] = true;
    std::vector<std::uint32_t> group{i};
    for (std::size_t k = 0; k < group.size(); ++k)
      grid.for_each_within(points[group[k]], reach_m, [&](std::uint32_t j, float) {
        if (!seen[j]) seen[j] = true, group.push_back(j);
      });
    groups.push_back(std::move(group));
  }
  return groups;
}

// As tall as one who stands, narrow, and round rather than flat.
bool of_a_persons_size(const Points& points, std::span<const std::uint32_t> group, const Eigen::Vector3f& up) {
  constexpr std::size_t kLeastPoints = 12;
  constexpr float kLeastHeightM = 1.1f, kMostHeightM = 2.1f, kMostWidthM = 1.2f, kLeastDepthM = 0.12f;
  if (group.size() < kLeastPoints) return false;
  const Eigen::Vector3f east = up.unitOrthogonal(), north = up.cross(east);
  const auto flat = [&](std::uint32_t i) { return Eigen::Vector2f(points[i].dot(east), points[i].dot(north)); };
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  for (const std::uint32_t i : group) mean += flat(i);
  mean /= static_cast<float>(group.size());
  Eigen::Matrix2f covariance = Eigen::Matrix2f::Zero();
  for (const std::uint32_t i : group) covariance += (flat(i) - mean) * (flat(i) - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> solver(covariance);
  const auto size_along = [&](const auto& coordinate) {
    const auto [low, high] = std::ranges::minmax(group, {}, coordinate);
    return coordinate(high) - coordinate(low);
  };
  const float height = size_along([&](std::uint32_t i) { return points[i].dot(up); });
  const float depth = size_along([&](std::uint32_t i) { return solver.eigenvectors().col(0).dot(flat(i)); });
  const float width = size_along([&](std::uint32_t i) { return solver.eigenvectors().col(1).dot(flat(i)); });
  return height >= kLeastHeightM && height <= kMostHeightM && width <= kMostWidthM && depth >= kLeastDepthM;
}

// Whether little else of the scan is near the group: the floor it stands on, not the wall that it is a part of.
bool stands_free(const PointGrid& grid, const Points& points, std::span<const std::uint32_t> group, float reach_m) {
  constexpr double kMostOthers = 0.42;  // of what is near
  std::vector<std::uint32_t> near;
  for (const std::uint32_t i : group)
    grid.for_each_within(points[i], reach_m, [&](std::uint32_t j, float) { near.push_back(j); });
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return static_cast<double>(near.size() - group.size()) <= kMostOthers * static_cast<double>(near.size());
}

}  // namespace

std::size_t num_of_passers_by(const ScanModel& scan, std::span<const std::uint32_t> contradicted) {
  constexpr float kCoarsestVoxelM = 0.3f, kReachVoxels = 2.75f;
  constexpr double kMostContradicted = 0.15;
  const std::vector<DominantAxis>& axes = scan.features.axes;
  if (axes.empty() || !axes.front().upright || scan.voxel_m > kCoarsestVoxelM || contradicted.empty() ||
      static_cast<double>(contradicted.size()) > kMostContradicted * static_cast<double>(scan.points.size()))
    return 0;
  const float reach_m = kReachVoxels * scan.voxel_m;
  Points points;
  for (const std::uint32_t i : contradicted) points.push_back(scan.points[i]);
  std::vector<std::vector<std::uint32_t>> groups = groups_of(points, reach_m);
  std::erase_if(groups, [&](const auto& group) { return !of_a_persons_size(points, group, axes.front().direction); });
  if (groups.empty()) return 0;
  const PointGrid all(scan.points, reach_m);
  std::size_t count = 0;
  for (const auto& group : groups) count += stands_free(all, points, group, reach_m) ? group.size() : 0;
  return count;
}

}  // namespace isthmus
