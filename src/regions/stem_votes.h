// Seeds from where slender upright things stand: trunks, posts, columns.
#pragma once

#include <vector>

#include "regions/seeds.h"

namespace isthmus {

struct StemVoteOptions {
  int min_layers = 6;           ///< voxel layers in which a stem stands free
  std::size_t min_stems = 5;    ///< in each scan
  std::size_t max_stems = 400;  ///< the tallest of each scan
  float yaw_step_rad = 0.035f;  ///< 2 degrees: half a step is a cell at 57 cells from the middle
  float cell_voxels = 2;
  std::size_t peaks_per_turn = 16;
  std::size_t max_settled = 1200;  ///< peaks whose stems are matched one by one
  std::size_t max_seeds = 16;
};

/// Assumes that `source_axis` and `target_axis` (unit, local frames) are the same direction of the scene. For every
/// turn about it, all pairs of stems vote for the shift between them (Hough voting); each of the heaviest peaks is
/// moved to where the stems agree, and scored by the log likelihood ratio of the places of the source's stems: found
/// where the target has stems, against anywhere at the density of the target's stems. Two scans that see a trunk from
/// opposite sides share none of its surface, but its axis. Seeds carry that ratio as score and votes, the likeliest
/// first; only positive ones are kept. Deterministic.
std::vector<Seed> vote_seeds_by_stems(const ScanModel& source, const ScanModel& target,
                                      const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                      const StemVoteOptions& options);

/// Whether the likeliest of these seeds (the first) is beyond doubt: far likelier than chance and than any other place.
bool stems_settle(const std::vector<Seed>& seeds);

}  // namespace isthmus
