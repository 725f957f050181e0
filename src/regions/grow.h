// Growth of the complete overlap from an initial sub-region.
#pragma once

#include <cstdint>
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

/// Source points spread over the scan, nearest to a region's centre first: the order in which its growth takes them.
struct GrowthOrder {
  std::vector<std::uint32_t> points;
  std::vector<float> distance_m;
};
GrowthOrder growth_order(const ScanModel& source, std::uint32_t region, const GrowOptions& options);

/// Aligns the neighbourhood of the seed's region, then ever wider ones, each step point-to-plane on what faces the
/// target's surface, until the whole scan is covered: the rotation error shrinks before far points may have a say.
/// `order`: growth_order() of the seed's region with the same options; seeds of one region share it.
GrownOverlap grow(const ScanModel& source, const ScanModel& target, const Seed& seed, const GrowthOrder& order,
                  const GrowOptions& options);
GrownOverlap grow(const ScanModel& source, const ScanModel& target, const Seed& seed, const GrowOptions& options);

/// grow() of each seed, the order of each region made once.
std::vector<GrownOverlap> grow_all(const ScanModel& source, const ScanModel& target, std::span<const Seed> seeds,
                                   const GrowOptions& options);

/// Support of both directions less contradiction, the one number hypotheses are ranked by before the evidence is
/// complete.
float ranking_score(const DirectedScore& source_in_target, const DirectedScore& target_in_source);

}  // namespace isthmus
