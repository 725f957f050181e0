// What a surveyor may turn in the division of keypoints.
#pragma once

#include <string>

#include "config/option_table.h"

namespace isthmus {

struct RegionOptions {
  std::string division = "clusters";  ///< a name of the table of divisions (divisions.h)
  int keypoints_per_region = 40;
  double planes_angle_deg = 15;          ///< planes: how far a point's normal may turn from its patch
  double planes_distance_voxels = 0.5;   ///< planes: how far a point may lie off its patch
  int spectral_neighbours = 10;          ///< spectral: nearest keypoints that a keypoint is tied to
  double differences_angle_deg = 10;     ///< differences: angle of neighbouring normals where a boundary begins
  double differences_variation = 0.015;  ///< differences: step in surface variation where a boundary begins
};
const config::OptionTable<RegionOptions>& region_options_table();

}  // namespace isthmus
