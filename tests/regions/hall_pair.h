// Two partly overlapping scans of a hall with their lookups.
#pragma once

#include "pairwise/synthetic_product.h"
#include "regions/scan_model.h"
#include "regions/seeds.h"

namespace isthmus::testing {

struct HallPair {
  PartialOverlap data;
  ScanModel source{data.source.sampled, data.source.features, data.source.regions, ModelLevel::coarse};
  ScanModel target{data.target.sampled, data.target.features, data.target.regions, ModelLevel::coarse};

  explicit HallPair(const Eigen::Vector3d& source_rotation = {0, 0, 2.1}, std::uint64_t hall = 1)
      : data(partial_overlap(hall, source_rotation)) {}
  HallPair(const HallPair&) = delete;  // the lookups point into data
};

inline std::vector<std::uint32_t> all_points(const ScanModel& model) {
  std::vector<std::uint32_t> all(model.points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

/// The seed that puts the region where `t` puts it.
inline Seed seed_at(const ScanModel& source, std::uint32_t region, const Transform& t) {
  Seed seed;
  seed.source_region = region;
  seed.rotation = t.linear().cast<float>();
  seed.centre_in_target = (t * source.regions.regions[region].centre.cast<double>()).cast<float>();
  return seed;
}

/// Share of the source points within radius_m of the region's centre that have the target's surface under them at `t`.
inline double share_in_overlap(const HallPair& pair, std::uint32_t region, float radius_m, const Transform& t) {
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < pair.source.points.size(); ++i)
    if ((pair.source.points[i] - pair.source.regions.regions[region].centre).norm() < radius_m) near.push_back(i);
  return static_cast<double>(score_direction(pair.source, pair.target, pose3f(t), near, 1, false).support);
}

}  // namespace isthmus::testing
