// From synthetic points to what the pair stage takes.
#pragma once

#include "features/describe.h"
#include "pairwise/register_pair.h"
#include "regions/divide.h"
#include "scan/sample_points.h"

namespace isthmus::testing {

inline ScanProduct product_of(const Points& points, double voxel_m, const SamplingSetup& setup = {},
                              const FeatureOptions& features = {}) {
  ScanProduct product;
  product.sampled = sampled(points, voxel_m, setup);
  product.features = describe(product.sampled, features);
  product.regions = divide(product.sampled, product.features, {});
  return product;
}

/// A bare floor seen from a station above it: nothing stands on it.
inline ScanProduct bare_floor() {
  Scene floor;
  floor.add_rectangle({-9, -9, -1.5}, {18, 0, 0}, {0, 18, 0});
  SamplingSetup setup;
  setup.options.station = "origin";
  return product_of(scan_scene(floor, pose_of({0, 0, 0}), {40000, 12, 0.002, 1}), 0.3, setup);
}

/// Largest distance between where `a` and `b` put a point of the source (over its voxel points).
inline double largest_displacement_m(const ScanProduct& source, const Transform& a, const Transform& b) {
  double largest = 0;
  for (const auto& p : source.sampled.points) largest = std::max(largest, displacement_m(a, b, p.cast<double>()));
  return largest;
}

/// Two scans of one hall from stations 6 m apart that see 11 m far, so that they share a part only; the source is
/// turned by `rotation_vector` about its station.
struct PartialOverlap {
  ScanProduct source, target;
  Transform target_from_source;
};

inline constexpr double kHallVoxel = 0.2;

inline PartialOverlap partial_overlap(std::uint64_t hall_seed, const Eigen::Vector3d& rotation_vector,
                                      std::size_t num_rays = 60000) {
  const Scene hall = furnished_hall(hall_seed);
  const Transform world_from_source = pose_of({-3, -1, 1.7}, rotation_vector),
                  world_from_target = pose_of({3, 0.7, 1.8});
  const Points source = scan_scene(hall, world_from_source, {num_rays, 11, 0.004, 11});
  const Points target = scan_scene(hall, world_from_target, {num_rays, 11, 0.004, 12});
  return {product_of(source, kHallVoxel), product_of(target, kHallVoxel),
          world_from_target.inverse() * world_from_source};
}

}  // namespace isthmus::testing
