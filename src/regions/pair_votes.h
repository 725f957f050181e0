// Seeds without any common axis: pairs of oriented matches, six degrees of freedom.
#pragma once

#include <vector>

#include "regions/seeds.h"

namespace isthmus {

struct PairVoteOptions {
  std::uint32_t matches_per_keypoint = 3;
  float window_voxels = 18;
  std::size_t max_matches = 500;  ///< of a window, most similar first
  float min_baseline_voxels = 5;
  float distance_tolerance_voxels = 1.2f;
  float cosine_tolerance = 0.2f;
  float position_cell_voxels = 3;
  float rotation_cell = 0.14f;  ///< of the unit quaternion's vector part: about 16 degrees
  std::uint32_t peaks_per_region = 8;
};

/// In the window of each source region, every two matches whose distance and angles between normals and baseline agree
/// (the point pair features of Drost et al. 2010, section 3.2, and their handedness) give a rigid transform and vote
/// for it; peaks become seeds. Deterministic.
std::vector<Seed> vote_seeds_by_pairs(const ScanModel& source, const ScanModel& target, const MatchTable& matches,
                                      const PairVoteOptions& options);

}  // namespace isthmus
