#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "geometry/point_grid.h"
#include "regions/divisions.h"
#include "regions/region_parts.h"
#include "regions/surface_graph.h"

namespace isthmus {
namespace {

constexpr float kFlatVariation = 0.04f;     // rougher points have no normal worth following (dominant axes use 0.03)
constexpr std::size_t kSmallestPatch = 20;  // points: a square of about 4 x 4 voxels with its rim
constexpr std::size_t kFirstFit = 8;      // points from which a plane is fitted; before, the first normal stands for it
constexpr double kFitGrowth = 1.5;        // then again whenever the patch has grown so much
constexpr float kEdgeReachVoxels = 2.5f;  // a keypoint this near to two patches lies where they meet
constexpr std::size_t kEdgeSupport = 3;   // points of a patch that must be as near
constexpr std::size_t kTies = 8;          // nearest keypoints that a small region may join by

// A plane that is fitted again as its patch grows.
class GrowingPlane {
 public:
  GrowingPlane(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) : start_(point), normal_(normal) {}

  [[nodiscard]] bool holds(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float min_cosine, float distance) const {
    return n.dot(normal_) >= min_cosine && std::abs(normal_.dot(p - start_ - centre_)) <= distance;
  }
  [[nodiscard]] const Eigen::Vector3f& normal() const { return normal_; }

  void add(const Eigen::Vector3f& p) {
    const Eigen::Vector3d d = (p - start_).cast<double>();
    sum_ += d;
    outer_ += d * d.transpose();
    if (static_cast<double>(++count_) >= next_fit_) fit();
  }

 private:
  void fit() {
    const auto n = static_cast<double>(count_);
    const Eigen::Vector3d mean = sum_ / n;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(outer_ / n - mean * mean.transpose());
    const Eigen::Vector3f across = solver.eigenvectors().col(0).cast<float>();
    normal_ = across.dot(normal_) < 0 ? Eigen::Vector3f(-across) : across;
    centre_ = mean.cast<float>();
    next_fit_ = kFitGrowth * n;
  }

  Eigen::Vector3f start_, normal_;
  Eigen::Vector3f centre_ = Eigen::Vector3f::Zero();  // relative to start_
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d outer_ = Eigen::Matrix3d::Zero();
  std::size_t count_ = 0;
  double next_fit_ = kFirstFit;
};

struct Patches {
  std::vector<std::uint32_t> patch_of_point;  // kNoGroup: on none
  std::vector<Eigen::Vector3f> normals;       // of each patch
};

// A patch from a start: takes free neighbours as long as they lie on its plane and face its way.
struct PatchGrowth {
  const SampledScan& scan;
  const SurfaceGraph& graph;
  float min_cosine, distance_m;
  std::vector<std::uint32_t> members = {};

  /// Marks the members with `name`; returns the normal of the plane.
  Eigen::Vector3f from(std::uint32_t start, std::uint32_t name, std::vector<std::uint32_t>& patch_of_point) {
    GrowingPlane plane(scan.points[start], scan.normals[start]);
    members.assign(1, start);
    patch_of_point[start] = name;
    for (std::size_t k = 0; k < members.size(); ++k) {
      plane.add(scan.points[members[k]]);
      for (const std::uint32_t j : graph.around(members[k])) {
        if (patch_of_point[j] != kNoGroup || scan.variation[j] > kFlatVariation) continue;
        if (!plane.holds(scan.points[j], scan.normals[j], min_cosine, distance_m)) continue;
        patch_of_point[j] = name;
        members.push_back(j);
      }
    }
    return plane.normal();
  }
};

// The flattest free point starts a patch, until none is left that is flat.
Patches planar_patches(const SampledScan& scan, const SurfaceGraph& graph, const RegionOptions& options) {
  const auto min_cosine = static_cast<float>(std::cos(options.planes_angle_deg * std::numbers::pi / 180));
  const auto distance_m = static_cast<float>(options.planes_distance_voxels * scan.voxel_m);
  std::vector<std::uint32_t> order(scan.points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return scan.variation[i]; });
  Patches patches{std::vector<std::uint32_t>(scan.points.size(), kNoGroup), {}};
  PatchGrowth growth{scan, graph, min_cosine, distance_m};
  for (const std::uint32_t start : order) {
    if (scan.variation[start] > kFlatVariation) break;
    if (patches.patch_of_point[start] != kNoGroup) continue;
    const auto name = static_cast<std::uint32_t>(patches.normals.size());
    const Eigen::Vector3f normal = growth.from(start, name, patches.patch_of_point);
    if (growth.members.size() >= kSmallestPatch)
      patches.normals.push_back(normal);
    else
      for (const std::uint32_t i : growth.members) patches.patch_of_point[i] = kNoGroup;
  }
  return patches;
}

// The patches that have points near `p`, the best supported first.
std::vector<std::uint32_t> patches_near(const Patches& patches, const PointGrid& grid, const Eigen::Vector3f& p,
                                        float reach_m) {
  std::map<std::uint32_t, std::size_t> support;
  grid.for_each_within(p, reach_m, [&](std::uint32_t i, float) {
    if (patches.patch_of_point[i] != kNoGroup) ++support[patches.patch_of_point[i]];
  });
  std::vector<std::pair<std::size_t, std::uint32_t>> ranked;
  for (const auto& [patch, points] : support)
    if (points >= kEdgeSupport) ranked.emplace_back(points, patch);
  std::ranges::stable_sort(ranked, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::uint32_t> names;
  for (const auto& [points, patch] : ranked) names.push_back(patch);
  return names;
}

// A keypoint near two patches of different planes belongs to their edge, near one to that patch, else to the rest. Two
// patches of one plane (a wall behind a pillar) have no edge.
Groups on_patches_and_edges(const SampledScan& scan, const FeatureCloud& features, const Patches& patches,
                            const RegionOptions& options) {
  const float reach_m = kEdgeReachVoxels * static_cast<float>(scan.voxel_m);
  const auto same_plane = static_cast<float>(std::cos(options.planes_angle_deg * std::numbers::pi / 180));
  const PointGrid grid(scan.points, reach_m);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  Groups groups;
  for (const std::uint32_t i : features.keypoints) {
    const auto near = patches_near(patches, grid, scan.points[i], reach_m);
    const std::uint32_t own =
        patches.patch_of_point[i] != kNoGroup || near.empty() ? patches.patch_of_point[i] : near[0];
    const auto other = std::ranges::find_if(near, [&](std::uint32_t patch) {
      return patch != own && patches.normals[patch].dot(patches.normals[own]) < same_plane;
    });
    if (own == kNoGroup || other == near.end()) {
      groups.push_back(own);
    } else {
      const auto name = static_cast<std::uint32_t>(patches.normals.size() + edges.size());
      groups.push_back(edges.try_emplace(std::minmax(own, *other), name).first->second);
    }
  }
  return groups;
}

}  // namespace

RegionMap divide_by_planes(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options) {
  const SurfaceGraph graph(scan, kSurfaceReachVoxels * static_cast<float>(scan.voxel_m));
  const Patches patches = planar_patches(scan, graph, options);
  const auto points = keypoint_positions(scan, features);
  const NearestPoints nearest = nearest_points(points, kTies, kKeypointReachVoxels * static_cast<float>(scan.voxel_m));
  return region_map_of(scan, features,
                       of_similar_size(points, nearest, on_patches_and_edges(scan, features, patches, options),
                                       static_cast<std::size_t>(options.keypoints_per_region)));
}

}  // namespace isthmus
