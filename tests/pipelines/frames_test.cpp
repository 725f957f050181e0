#include "pipelines/frames.h"

#include <gtest/gtest.h>

#include "base/rng.h"

namespace isthmus::pipelines {
namespace {

Eigen::Vector3d random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

Transform random_transform(Rng& rng) {
  Transform t = Transform::Identity();
  t.linear() = rotation_from_vector(random_vector(rng, 3));
  t.translation() = random_vector(rng, 20);
  return t;
}

TEST(ScanFrames, carry_points_as_the_local_frames_do_at_map_coordinates) {
  Rng rng(1);
  const Eigen::Vector3d source_origin(500000, 5240000, 300), target_origin(500100, 5240050, 310);
  const Transform local = random_transform(rng);
  const Transform scan = between_scan_frames(local, source_origin, target_origin);
  const Eigen::Vector3d p = random_vector(rng, 50);
  EXPECT_LT((scan * (p + source_origin) - (local * p + target_origin)).norm(), 1e-8);
}

TEST(ScanFrames, are_the_local_frames_when_the_origins_are_zero) {
  Rng rng(2);
  const Transform local = random_transform(rng);
  EXPECT_EQ(between_scan_frames(local, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()).matrix(), local.matrix());
}

}  // namespace
}  // namespace isthmus::pipelines
