// SampledScan -> FeatureCloud: ISS keypoints with a uniform top-up, FPFH at two radii, dominant axes.
#pragma once

#include "config/option_table.h"
#include "features/feature_cloud.h"
#include "scan/sampled_scan.h"

namespace isthmus {

struct FeatureOptions {
  double iss_radius_voxels = 5.0;
  double iss_gamma = 0.95;
  double keypoint_spacing_voxels = 2.0;
  int max_keypoints = 4000;
  double radius_voxels = 5.0;
  double large_radius_voxels = 10.0;
};
const config::OptionTable<FeatureOptions>& feature_options_table();

/// Deterministic for any thread count. A scan too small or too flat for features gives an empty cloud, never an error.
FeatureCloud describe(const SampledScan& scan, const FeatureOptions& options);

}  // namespace isthmus
