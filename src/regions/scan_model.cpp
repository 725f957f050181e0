#include "regions/scan_model.h"

#include <algorithm>

#include "regions/upright_memo.h"
#include "scan/free_space.h"

namespace isthmus {

ScanModel::ScanModel(const SampledScan& sampled, const FeatureCloud& cloud, const RegionMap& map, ModelLevel level,
                     UprightMemo* shared)
    : scan(sampled),
      features(cloud),
      regions(map),
      own_(shared ? nullptr : std::make_unique<UprightMemo>()),
      uprights_(shared ? shared : own_.get()) {
  const bool use_fine = level == ModelLevel::fine && !sampled.fine.points.empty();
  voxel_m = static_cast<float>(use_fine ? sampled.fine.voxel_m : sampled.voxel_m);
  points = use_fine ? sampled.fine.points : sampled.points;
  normals = use_fine ? sampled.fine.normals : sampled.normals;
  variation = use_fine ? sampled.fine.variation : sampled.variation;
  if (points.empty()) return;
  fine = SurfaceLookup(points, voxel_m, use_fine ? 2 : 1);  // about the same reach in metres at both levels
  if (level == ModelLevel::coarse) coarse = SurfaceLookup(points, 2 * voxel_m, 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p.cast<double>();
  centroid = (sum / static_cast<double>(points.size())).cast<float>();
  std::vector<float> distance(points.size());
  for (std::size_t i = 0; i < distance.size(); ++i) distance[i] = (points[i] - centroid).norm();
  const auto k = static_cast<std::ptrdiff_t>(distance.size() * 95 / 100);
  std::nth_element(distance.begin(), distance.begin() + k, distance.end());
  extent_m = distance[static_cast<std::size_t>(k)];
}

ScanModel::~ScanModel() = default;

bool ScanModel::seen_through(const Eigen::Vector3f& p, float tolerance_m) const {
  constexpr float kRelativeTolerance = 0.02f;
  if (scan.free_space.size == 0) return false;
  const Eigen::Vector3f ray = p - scan.station;
  const float nearest = scan.free_space.nearest_m[cube_cell(ray, scan.free_space.size)];
  const float range = ray.norm();
  return std::isfinite(nearest) &&
         range < nearest - tolerance_m - static_cast<float>(scan.station_sigma_m) - kRelativeTolerance * range;
}

}  // namespace isthmus
