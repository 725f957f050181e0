// Seeds from what stands upright: columns of walls, trunks and posts seen from above, without descriptors.
#pragma once

#include <vector>

#include "regions/ground_plan.h"
#include "regions/seeds.h"

namespace isthmus {

struct ColumnVoteOptions {
  GroundPlanOptions plan;
  float yaw_step_rad = 0.06f;      ///< 3.4 degrees: half a step is a cell at 100 voxels from the middle
  std::size_t max_checked = 1200;  ///< peaks looked at in three dimensions
  std::size_t max_seeds = 120;
};

/// Assumes that `source_axis` and `target_axis` (unit, local frames) are the same direction of the scene. For every
/// turn about it, each two columns that face the same way vote for the shift between them (Hough voting over the whole
/// plan); a column weighs by how rare its facing is nearby, so that a long wall does not outvote a row of trunks. The
/// fewer turns are likely (four in a building), the more peaks of each are looked at: repeated rooms outvote the truth.
/// The heights at which horizontal surfaces and columns meet settle the shift along the axis. Peaks are scored on
/// points of the whole overlap, support against contradiction, and the best become seeds. Deterministic.
std::vector<Seed> vote_seeds_by_columns(const ScanModel& source, const ScanModel& target,
                                        const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                        const ColumnVoteOptions& options);

}  // namespace isthmus
