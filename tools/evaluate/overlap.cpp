#include "evaluate/overlap.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "evaluate/kd_tree.h"

namespace isthmus::evaluate {
namespace {

constexpr std::size_t kNormalNeighbours = 10;
constexpr std::size_t kFacingCandidates = 4;
constexpr double kReachVoxels = 1.5;
constexpr double kFacingCosine = 0.3;
constexpr std::size_t kGrain = 256;

Eigen::Vector3d normal_at(const Points& points, const std::vector<Neighbour>& neighbours) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Neighbour& n : neighbours) mean += points[n.index];
  mean /= static_cast<double>(neighbours.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : neighbours) scatter += (points[n.index] - mean) * (points[n.index] - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
}

double covered_share(const Surface& a, const Surface& b, const KdTree& tree_of_b, double voxel_m) {
  std::vector<char> covered(a.points.size(), 0);
  parallel_for_index(a.points.size(), kGrain, [&](std::size_t i) {
    std::vector<Neighbour> near;
    tree_of_b.nearest(a.points[i], kFacingCandidates, kReachVoxels * voxel_m, near);
    covered[i] = std::any_of(near.begin(), near.end(),
                             [&](const Neighbour& n) { return a.normals[i].dot(b.normals[n.index]) > kFacingCosine; });
  });
  return std::accumulate(covered.begin(), covered.end(), 0.0) / static_cast<double>(covered.size());
}

}  // namespace

Surface surface_of(const Points& points_in_scan, const Transform& common_from_scan, double voxel_m) {
  Surface surface;
  for (const Eigen::Vector3d& p : voxel_sampled(points_in_scan, voxel_m))
    surface.points.push_back(common_from_scan * p);
  const KdTree tree(surface.points);
  const Eigen::Vector3d station = common_from_scan.translation();
  surface.normals.resize(surface.points.size());
  parallel_for_index(surface.points.size(), kGrain, [&](std::size_t i) {
    std::vector<Neighbour> near;
    tree.nearest(surface.points[i], kNormalNeighbours, std::numeric_limits<double>::infinity(), near);
    const Eigen::Vector3d n = normal_at(surface.points, near);
    surface.normals[i] = n.dot(station - surface.points[i]) + 1e-12 < 0 ? Eigen::Vector3d(-n) : n;
  });
  return surface;
}

double covered_share(const Surface& a, const Surface& b, double voxel_m) {
  return covered_share(a, b, KdTree(b.points), voxel_m);
}

Result<Overlaps> compute_overlaps(const std::filesystem::path& scans_dir, const Poses& truth, double voxel_m) {
  Poses sorted = truth;
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Surface> surfaces;
  for (const auto& [name, pose] : sorted) {
    const Result<Points> points = load_points(scans_dir, name);
    if (!points) return tl::unexpected(points.error());
    surfaces.push_back(surface_of(*points, pose, voxel_m));
  }
  std::vector<KdTree> trees;
  for (const Surface& surface : surfaces) trees.emplace_back(surface.points);
  Overlaps overlaps{voxel_m, {}};
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t j = i + 1; j < sorted.size(); ++j)
      overlaps.of[pair_key(sorted[i].first, sorted[j].first)] =
          std::min(covered_share(surfaces[i], surfaces[j], trees[j], voxel_m),
                   covered_share(surfaces[j], surfaces[i], trees[i], voxel_m));
  return overlaps;
}

}  // namespace isthmus::evaluate
