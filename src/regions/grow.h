// Growth of the complete overlap from an initial sub-region.
#pragma once

#include <span>
#include <vector>

#include "geometry/transform.h"
#include "regions/seeds.h"

namespace isthmus {

struct GrowOptions {
  float start_radius_voxels = 18;
  float growth = 1.6f;           ///< of the radius, each step
  std::size_t max_points = 700;  ///< of the source, in each step
  int final_steps = 3;
};

struct GrownOverlap {
  Transform target_from_source = Transform::Identity();
  DirectedScore source_in_target, target_in_source;
  float score = 0;
  std::size_t matches = 0;
  double rms_m = 0;
};

/// Aligns the neighbourhood of the seed's region, then ever wider ones, each step point-to-plane on what faces the
/// target's surface, until the whole scan is covered: the rotation error shrinks before far points may have a say.
GrownOverlap grow(const ScanModel& source, const ScanModel& target, const Seed& seed, const GrowOptions& options);

/// grow() of each seed; seeds of one region share the order in which its points are taken.
std::vector<GrownOverlap> grow_all(const ScanModel& source, const ScanModel& target, std::span<const Seed> seeds,
                                   const GrowOptions& options);

/// Support of both directions less contradiction, the one number hypotheses are ranked by before the evidence is
/// complete.
float ranking_score(const DirectedScore& source_in_target, const DirectedScore& target_in_source);

}  // namespace isthmus
