// What a pair needs to ask of a scan thousands of times: is there a surface here, was this place seen through?
#pragma once

#include <memory>
#include <span>

#include "features/feature_cloud.h"
#include "geometry/surface_lookup.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

class UprightMemo;

enum class ModelLevel : std::uint8_t {
  coarse,  ///< the scan's voxels: features, regions, growth
  fine,    ///< the finer sampling, or the coarse one where there is none: last alignment and evidence
};

/// Lookups built once per scan and pair session; keeps references to the scan's products.
class ScanModel {
 public:
  /// `shared`: what models of the same scan and level found upright; by default the model remembers for itself.
  ScanModel(const SampledScan& scan, const FeatureCloud& features, const RegionMap& regions, ModelLevel level,
            UprightMemo* shared = nullptr);
  ~ScanModel();
  ScanModel(const ScanModel&) = delete;
  ScanModel& operator=(const ScanModel&) = delete;

  const SampledScan& scan;
  const FeatureCloud& features;
  const RegionMap& regions;
  float voxel_m;  ///< of this level
  std::span<const Eigen::Vector3f> points, normals;
  std::span<const float> variation;
  SurfaceLookup fine;    ///< nearest point within about 1.5 coarse voxels
  SurfaceLookup coarse;  ///< nearest point within about 3 voxels; only at the coarse level
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  float extent_m = 0;  ///< radius about the centroid that holds 95 % of the points

  /// True where the station looked through `p` (local frame): p lies in front of everything seen in its direction, by
  /// more than tolerance_m plus 2 % of the range.
  [[nodiscard]] bool seen_through(const Eigen::Vector3f& p, float tolerance_m) const;

  /// Stems and ground plans that were asked for before.
  [[nodiscard]] UprightMemo& uprights() const { return *uprights_; }

 private:
  std::unique_ptr<UprightMemo> own_;
  UprightMemo* uprights_;
};

}  // namespace isthmus
