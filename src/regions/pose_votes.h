// Seeds by votes under a common axis: one oriented match is a whole pose hypothesis (method.md, facts).
#pragma once

#include <vector>

#include "regions/seeds.h"

namespace isthmus {

struct VoteOptions {
  std::uint32_t matches_per_keypoint = 15;
  float window_voxels = 16;  ///< keypoints this close to a region's centre vote for it
  float position_cell_voxels = 2.5f;
  float yaw_cell_rad = 0.10f;
  std::uint32_t peaks_per_region = 8;
};

/// Assumes that `source_axis` and `target_axis` (unit, local frames) are the same direction of the scene. Every match
/// whose normals make the same angle with the axis votes, in the window of each source region, for the turn about the
/// axis and the place of the region's centre in the target; peaks become seeds (Hough voting; Ballard 1981).
/// Deterministic.
std::vector<Seed> vote_seeds_about_axis(const ScanModel& source, const ScanModel& target, const MatchTable& matches,
                                        const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                        const VoteOptions& options);

}  // namespace isthmus
