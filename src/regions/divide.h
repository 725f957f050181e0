// FeatureCloud -> RegionMap: division of the keypoints into feature regions.
#pragma once

#include "config/option_table.h"
#include "features/feature_cloud.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

struct RegionOptions {
  std::string division = "clusters";
  int keypoints_per_region = 40;
};
const config::OptionTable<RegionOptions>& region_options_table();

/// Every keypoint belongs to exactly one region; deterministic.
RegionMap divide(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);

}  // namespace isthmus
