#include <algorithm>

#include "regions/compact_clusters.h"
#include "regions/divisions.h"
#include "regions/region_parts.h"

namespace isthmus {

RegionMap divide_by_clusters(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options) {
  const auto points = keypoint_positions(scan, features);
  const auto wanted = static_cast<std::size_t>(options.keypoints_per_region);
  return region_map_of(scan, features, compact_clusters(points, std::max<std::size_t>(1, points.size() / wanted)));
}

}  // namespace isthmus
