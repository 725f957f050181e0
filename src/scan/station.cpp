#include "scan/station.h"

#include <algorithm>
#include <vector>

namespace isthmus {

SightLines::SightLines(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals, float voxel_m)
    : points_(points), normals_(normals), voxel_m_(voxel_m) {
  if (!points.empty()) lookup_ = SurfaceLookup(points, voxel_m, 1);
}

StationCheck SightLines::from(const Eigen::Vector3f& station) const {
  constexpr std::size_t kLines = 1500;
  constexpr float kNearTargetVoxels = 6;    // surfaces this close to the end belong to the target itself
  constexpr float kThicknessVoxels = 0.4f;  // a surface point blocks lines passing this close
  constexpr float kMinCosine = 0.35f;       // surfaces seen edge-on do not block: floors under a flat sight line
  StationCheck out;
  if (points_.empty()) return out;
  Eigen::Vector3d direction_sum = Eigen::Vector3d::Zero();
  std::size_t lines = 0, blocked = 0;
  std::vector<float> ranges;
  const std::size_t stride = std::max<std::size_t>(1, points_.size() / kLines);
  for (std::size_t i = 0; i < points_.size(); i += stride) {
    const Eigen::Vector3f to_point = points_[i] - station;
    const float range = to_point.norm();
    if (!(range > 0)) continue;
    const Eigen::Vector3f u = to_point / range;
    direction_sum += u.cast<double>();
    ++lines;
    ranges.push_back(range);
    const float end = range - kNearTargetVoxels * voxel_m_;
    const float step = std::max(0.7f * voxel_m_, end / 2000);
    for (float s = 0; s < end; s += step) {
      const std::int32_t k = lookup_.near(station + s * u);
      if (k < 0) continue;
      const Eigen::Vector3f d = points_[k] - station;
      const float along = d.dot(u);
      if (along > end || (d - along * u).norm() > kThicknessVoxels * voxel_m_) continue;
      if (std::abs(normals_[k].dot(u)) < kMinCosine) continue;
      ++blocked;
      break;
    }
  }
  if (lines == 0) return out;
  std::nth_element(ranges.begin(), ranges.begin() + static_cast<std::ptrdiff_t>(lines / 2), ranges.end());
  out.median_range_m = ranges[lines / 2];
  out.blocked = static_cast<double>(blocked) / static_cast<double>(lines);
  out.concentration = direction_sum.norm() / static_cast<double>(lines);
  return out;
}

}  // namespace isthmus
