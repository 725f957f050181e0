// FeatureCloud -> RegionMap: division of the keypoints into feature regions.
#pragma once

#include "features/feature_cloud.h"
#include "regions/options.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// Divides by the division that options.division names. Every keypoint belongs to exactly one region; the same bytes
/// for any number of threads. Precondition: the table of divisions holds the name (std::invalid_argument otherwise).
RegionMap divide(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);

}  // namespace isthmus
