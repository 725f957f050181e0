#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "regions/divisions.h"
#include "regions/region_parts.h"
#include "regions/surface_graph.h"

namespace isthmus {
namespace {

constexpr std::size_t kTies = 8;  // nearest keypoints that a small region may join by

// Disjoint sets whose representative is the smallest member.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = of(a), b = of(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Surfaces over which normals and variation change little from point to point. Which points hang together does not
// depend on where growing begins.
Sets smooth_surfaces(const SampledScan& scan, const RegionOptions& options) {
  const SurfaceGraph graph(scan, kSurfaceReachVoxels * static_cast<float>(scan.voxel_m));
  const auto min_cosine = static_cast<float>(std::cos(options.differences_angle_deg * std::numbers::pi / 180));
  const auto max_step = static_cast<float>(options.differences_variation);
  Sets surfaces(scan.points.size());
  for (std::uint32_t i = 0; i < scan.points.size(); ++i)
    for (const std::uint32_t j : graph.around(i)) {
      if (j > i || scan.normals[i].dot(scan.normals[j]) < min_cosine) continue;
      if (std::abs(scan.variation[i] - scan.variation[j]) <= max_step) surfaces.join(i, j);
    }
  return surfaces;
}

}  // namespace

RegionMap divide_by_differences(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options) {
  Sets surfaces = smooth_surfaces(scan, options);
  Groups groups;
  for (const std::uint32_t i : features.keypoints) groups.push_back(surfaces.of(i));
  const auto points = keypoint_positions(scan, features);
  const NearestPoints nearest = nearest_points(points, kTies, kKeypointReachVoxels * static_cast<float>(scan.voxel_m));
  const auto wanted = static_cast<std::size_t>(options.keypoints_per_region);
  return region_map_of(scan, features, of_similar_size(points, nearest, std::move(groups), wanted));
}

}  // namespace isthmus
