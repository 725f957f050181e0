// A plain with posts that all look alike: only where they stand tells one place from another.
#pragma once

#include "base/rng.h"
#include "regions/hall_pair.h"

namespace isthmus::testing {

/// A square post of this half width, 6 m tall, on z = 0.
inline void add_post(Scene& scene, const Eigen::Vector3d& foot, double heading, double half) {
  const Eigen::Vector3d u(half * std::cos(heading), half * std::sin(heading), 0), v(-u.y(), u.x(), 0), up(0, 0, 6);
  scene.add_rectangle(foot + u - v, 2 * v, up);
  scene.add_rectangle(foot - u - v, 2 * v, up);
  scene.add_rectangle(foot + v - u, 2 * u, up);
  scene.add_rectangle(foot - v - u, 2 * u, up);
}

inline Scene plain_ground() {
  Scene scene;
  scene.add_rectangle({-60, -60, 0}, {120, 0, 0}, {0, 120, 0});
  return scene;
}

inline Scene posts(std::uint64_t seed, double half) {
  Scene scene = plain_ground();
  Rng rng(seed);
  for (int k = 0; k < 90; ++k) {
    const Eigen::Vector3d p(rng.uniform(-40, 40), rng.uniform(-40, 40), 0);
    add_post(scene, p, rng.uniform(0, 6.28), half);
  }
  return scene;
}

/// 1 for the first of the seeds within five voxels and 0.1 rad of the truth; 0 if there is none.
inline int first_right(const ScanModel& source, const Transform& truth, const std::vector<Seed>& seeds) {
  const Eigen::Vector3d middle = source.centroid.cast<double>();
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    const Transform t = transform_of(seeds[k].target_from_source(source));
    if (displacement_m(t, truth, middle) < 5 * static_cast<double>(source.voxel_m) &&
        rotation_angle_rad(t.linear().transpose() * truth.linear()) < 0.1)
      return static_cast<int>(k) + 1;
  }
  return 0;
}

}  // namespace isthmus::testing
