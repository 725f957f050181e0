// The table of divisions: ways to divide a scan's keypoints into feature regions.
//
// A division is one file with one function, one row of the table in divisions.cpp and one section of
// docs/stages/regions.md. The function names a group for every keypoint as it likes and ends with region_map_of()
// (region_parts.h), which fills the regions.
#pragma once

#include <span>
#include <string_view>

#include "features/feature_cloud.h"
#include "regions/options.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// Precondition of every division: at least one keypoint. Deterministic for any number of threads.
struct Division {
  std::string_view name;  ///< the word for regions.division
  std::string_view help;  ///< one clause
  RegionMap (*divide)(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);
};

std::span<const Division> divisions();

/// Compact clusters: farthest-point seeds (Gonzalez 1985), then Lloyd's iterations (Lloyd 1982).
RegionMap divide_by_clusters(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);

/// Planar patches grown over the sampled points, and the edges where two patches meet; what lies on neither falls to
/// compact clusters. Region growing after Rabbani, van den Heuvel, Vosselman 2006; edges as regions are ours.
RegionMap divide_by_planes(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);

/// Recursive normalised cuts of the graph of neighbouring keypoints (Shi, Malik 2000).
RegionMap divide_by_spectrum(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);

/// Surfaces over which neighbouring normals and surface variation differ little; boundaries are where they do not.
RegionMap divide_by_differences(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options);

}  // namespace isthmus
