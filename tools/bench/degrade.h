// Scans made worse on purpose: noise, clutter, unlike densities.
#pragma once

#include <cstdint>
#include <string>

#include "base/rng.h"
#include "evaluate/scan_points.h"

namespace isthmus::bench {

struct Degradation {
  double noise_voxels = 0;  ///< standard deviation of a normal error on each coordinate, in evaluation voxels
  double outliers = 0;      ///< share of the points that are spread evenly over the scan's bounding box, in [0, 1)
  double density = 1;       ///< share of its points that every second scan keeps, in (0, 1]
  [[nodiscard]] bool none() const { return noise_voxels == 0 && outliers == 0 && density == 1; }
};

/// For names of folders: "-noise1-outliers0.3-density0.1", empty where nothing is made worse.
std::string suffix_of(const Degradation& degradation);

/// The points of one scan made worse, in the order density, noise, outliers; `thinned`: this is one of the scans whose
/// density is lowered. The outliers stand at random places of the list, not behind it, as in a measured scan.
evaluate::Points degraded(const evaluate::Points& points, const Degradation& degradation, bool thinned, double voxel_m,
                          Rng rng);

}  // namespace isthmus::bench
