// Initial overlapped sub-regions: a source region, where it may lie in the target, and how well that fits nearby.
#pragma once

#include <span>
#include <vector>

#include "regions/matching.h"
#include "regions/overlap_score.h"
#include "regions/scan_model.h"

namespace isthmus {

struct Seed {
  std::uint32_t source_region = 0;
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();      ///< target_from_source
  Eigen::Vector3f centre_in_target = Eigen::Vector3f::Zero();  ///< where the region's centre comes to lie
  float votes = 0;
  float score = 0;  ///< local support less contradiction, set by score_seeds()
  const char* generator = "";

  [[nodiscard]] Pose3f target_from_source(const ScanModel& source) const {
    return {rotation, centre_in_target - rotation * source.regions.regions[source_region].centre};
  }
};

struct SeedScoreOptions {
  float radius_voxels = 40;  ///< source points this close to the region's centre are looked at
  std::size_t max_points = 250;
  float contradiction_weight = 5;
};

/// Sets every seed's score from the points around its region, where its rotation error hardly counts.
void score_seeds(const ScanModel& source, const ScanModel& target, const SeedScoreOptions& options,
                 std::span<Seed> seeds);

/// A seed for each pose of whole scans (target_from_source): growth begins in the region with the most support around
/// it. Votes, score and generator are left to the caller.
std::vector<Seed> seeds_at_poses(const ScanModel& source, const ScanModel& target, std::span<const Pose3f> poses);

/// Best score first; of seeds that put the middle of the scan within `position_m` of each other and turn it alike
/// within `angle_rad` only the best stays, with the votes of all. At most `keep`.
std::vector<Seed> best_distinct_seeds(const ScanModel& source, std::vector<Seed> seeds, float position_m,
                                      float angle_rad, std::size_t keep);

}  // namespace isthmus
