// What a pair needs to ask of a scan thousands of times: is there a surface here, was this place seen through?
#pragma once

#include "features/feature_cloud.h"
#include "geometry/surface_lookup.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// Lookups built once per scan and pair session; keeps references to the scan's products.
class ScanModel {
 public:
  ScanModel(const SampledScan& scan, const FeatureCloud& features, const RegionMap& regions);

  const SampledScan& scan;
  const FeatureCloud& features;
  const RegionMap& regions;
  float voxel_m;
  SurfaceLookup fine;    ///< nearest point within about 1.5 voxels
  SurfaceLookup coarse;  ///< nearest point within about 3 voxels
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  float extent_m = 0;    ///< radius about the centroid that holds 95 % of the points

  /// True where the station looked through `p` (local frame): p lies in front of everything seen in its direction, by more
  /// than tolerance_m plus 2 % of the range.
  [[nodiscard]] bool seen_through(const Eigen::Vector3f& p, float tolerance_m) const;
};

}  // namespace isthmus
