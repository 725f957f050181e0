#include "features/describe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "features/axes.h"
#include "features/fpfh.h"
#include "features/iss.h"
#include "features/upright.h"
#include "geometry/point_grid.h"

namespace isthmus {

const config::OptionTable<FeatureOptions>& feature_options_table() {
  static const config::OptionTable<FeatureOptions> table{
      "features",
      "Keypoints and their descriptors.",
      {
          {"iss_radius_voxels",
           &FeatureOptions::iss_radius_voxels,
           "voxels",
           2,
           50,
           {},
           "Radius in which the shape around a point decides whether it is an ISS keypoint.",
           "Zhong 2009; docs/stages/features.md"},
          {"iss_gamma",
           &FeatureOptions::iss_gamma,
           "",
           0.1,
           1,
           {},
           "Largest ratio of successive eigenvalues of an ISS keypoint: 1 keeps all, smaller keeps only distinct "
           "shapes.",
           "Zhong 2009; PCL uses 0.975"},
          {"keypoint_spacing_voxels",
           &FeatureOptions::keypoint_spacing_voxels,
           "voxels",
           1,
           50,
           {},
           "Spacing of the even keypoints that top up the ISS ones, and the smallest distance of two keypoints.",
           "Flat-walled offices starve on ISS alone; docs/stages/features.md"},
          {"max_keypoints",
           &FeatureOptions::max_keypoints,
           "",
           50,
           100000,
           {},
           "Most keypoints of a scan; above it the spacing grows.",
           "matching time grows with the square"},
          {"radius_voxels",
           &FeatureOptions::radius_voxels,
           "voxels",
           2,
           50,
           {},
           "Radius of the small descriptor.",
           "Rusu, Blodow, Beetz 2009; docs/stages/features.md"},
          {"large_radius_voxels",
           &FeatureOptions::large_radius_voxels,
           "voxels",
           3,
           100,
           {},
           "Radius of the large descriptor, which tells repeated details apart by what is around them.",
           "docs/stages/features.md"},
      }};
  return table;
}

namespace {

// The most salient point of each cell, then a greedy pass that keeps points at least `spacing` apart.
std::vector<std::uint32_t> spread(const SampledScan& scan, std::span<const std::uint32_t> ranked, float spacing_m) {
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> kept;
  const auto cell = [&](const Eigen::Vector3f& p, int a) {
    return static_cast<std::int64_t>(std::floor(p[a] / spacing_m));
  };
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x & 0x1fffff) << 42 | static_cast<std::uint64_t>(y & 0x1fffff) << 21 |
           static_cast<std::uint64_t>(z & 0x1fffff);
  };
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t i : ranked) {
    const Eigen::Vector3f& p = scan.points[i];
    const std::int64_t x = cell(p, 0), y = cell(p, 1), z = cell(p, 2);
    bool free = true;
    for (std::int64_t dx = -1; dx <= 1 && free; ++dx)
      for (std::int64_t dy = -1; dy <= 1 && free; ++dy)
        for (std::int64_t dz = -1; dz <= 1 && free; ++dz) {
          const auto found = kept.find(key(x + dx, y + dy, z + dz));
          if (found == kept.end()) continue;
          for (const std::uint32_t j : found->second)
            if ((scan.points[j] - p).squaredNorm() < spacing_m * spacing_m) free = false;
        }
    if (!free) continue;
    kept[key(x, y, z)].push_back(i);
    chosen.push_back(i);
  }
  return chosen;
}

// Even thinning: the first point of each cell.
std::vector<std::uint32_t> thinned(const SampledScan& scan, float cell_m) {
  std::vector<std::uint32_t> all(scan.points.size());
  std::iota(all.begin(), all.end(), 0u);
  return spread(scan, all, cell_m);
}

void append_normalised(FeatureCloud& cloud, std::span<const float> small, std::span<const float> large) {
  cloud.dimension = 2 * kFpfhDimension;
  cloud.descriptors.resize(cloud.keypoints.size() * cloud.dimension);
  for (std::size_t k = 0; k < cloud.keypoints.size(); ++k) {
    float* row = &cloud.descriptors[k * cloud.dimension];
    double sq_norm = 0;
    for (std::uint32_t b = 0; b < kFpfhDimension; ++b) {  // square roots: Euclidean distance becomes Hellinger's
      row[b] = std::sqrt(small[k * kFpfhDimension + b]);
      row[kFpfhDimension + b] = std::sqrt(large[k * kFpfhDimension + b]);
      sq_norm +=
          static_cast<double>(row[b]) * row[b] + static_cast<double>(row[kFpfhDimension + b]) * row[kFpfhDimension + b];
    }
    const float scale = sq_norm > 0 ? static_cast<float>(1 / std::sqrt(sq_norm)) : 0.0f;
    for (std::uint32_t b = 0; b < cloud.dimension; ++b) row[b] *= scale;
  }
}

}  // namespace

FeatureCloud describe(const SampledScan& scan, const FeatureOptions& options) {
  constexpr float kThinningVoxels = 2.0f;  // carriers of the large descriptor
  constexpr std::size_t kMaxAxes = 3;      // a building has three
  constexpr float kSpacingGrowth = 1.12f;
  const auto voxel = static_cast<float>(scan.voxel_m);
  FeatureCloud cloud;
  const auto radius = static_cast<float>(options.iss_radius_voxels) * voxel;
  const std::vector<float> saliency =
      iss_saliency(scan.points, radius, 0.5f * radius, static_cast<float>(options.iss_gamma));

  std::vector<std::uint32_t> ranked;
  for (std::uint32_t i = 0; i < scan.points.size(); ++i)
    if (scan.variation[i] < 1.0f) ranked.push_back(i);  // without a normal there is no descriptor
  std::stable_sort(ranked.begin(), ranked.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (saliency[a] != saliency[b]) return saliency[a] > saliency[b];
    return scan.variation[a] > scan.variation[b];
  });
  float spacing = static_cast<float>(options.keypoint_spacing_voxels) * voxel;
  cloud.keypoints = spread(scan, ranked, spacing);
  while (cloud.keypoints.size() > static_cast<std::size_t>(options.max_keypoints)) {
    spacing *= kSpacingGrowth;
    cloud.keypoints = spread(scan, ranked, spacing);
  }
  std::sort(cloud.keypoints.begin(), cloud.keypoints.end());
  for (const std::uint32_t i : cloud.keypoints) cloud.saliency.push_back(saliency[i]);

  std::vector<std::uint32_t> all(scan.points.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto small =
      fpfh(scan.points, scan.normals, all, cloud.keypoints, static_cast<float>(options.radius_voxels) * voxel);
  const auto large = fpfh(scan.points, scan.normals, thinned(scan, kThinningVoxels * voxel), cloud.keypoints,
                          static_cast<float>(options.large_radius_voxels) * voxel);
  append_normalised(cloud, small, large);
  cloud.axes = dominant_axes(scan.normals, scan.variation, kMaxAxes);
  put_upright_first(scan, cloud.axes);
  return cloud;
}

}  // namespace isthmus
