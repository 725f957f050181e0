#include "features/describe.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pairwise/threads.h"
#include "scan/sample_points.h"
#include "store/archive.h"

namespace isthmus {
namespace {

using testing::furnished_hall;
using testing::pose_of;
using testing::sampled;
using testing::scan_scene;
using testing::Scene;

SampledScan hall() { return sampled(scan_scene(furnished_hall(1), pose_of({0, 0, 1.7}), {40000, 1e6, 0.003, 5}), 0.2); }

SampledScan one_plane() {
  Scene wall;
  wall.add_rectangle({-4, 3, -2}, {8, 0, 0}, {0, 0, 4});
  return sampled(scan_scene(wall, pose_of({0, 0, 0}), {60000, 1e6, 0, 1}), 0.15);
}

TEST(Describe, KeypointsAreSortedWithinTheScanAndHaveUnitDescriptors) {
  const SampledScan scan = hall();
  const FeatureCloud cloud = describe(scan, {});
  ASSERT_GT(cloud.keypoints.size(), 200u);
  ASSERT_GT(cloud.dimension, 0u);
  EXPECT_TRUE(std::is_sorted(cloud.keypoints.begin(), cloud.keypoints.end()));
  EXPECT_EQ(std::adjacent_find(cloud.keypoints.begin(), cloud.keypoints.end()), cloud.keypoints.end());
  EXPECT_LT(cloud.keypoints.back(), scan.points.size());
  EXPECT_EQ(cloud.saliency.size(), cloud.keypoints.size());
  ASSERT_EQ(cloud.descriptors.size(), cloud.keypoints.size() * cloud.dimension);
  for (std::size_t k = 0; k < cloud.keypoints.size(); ++k) {
    double sq = 0;
    for (std::uint32_t b = 0; b < cloud.dimension; ++b) {
      const float v = cloud.descriptors[k * cloud.dimension + b];
      ASSERT_TRUE(std::isfinite(v) && v >= 0);
      sq += static_cast<double>(v) * static_cast<double>(v);
    }
    EXPECT_NEAR(sq, 1, 1e-5);
  }
}

TEST(Describe, IssKeypointsComeFirstAndTheTopUpFillsTheRest) {
  const FeatureCloud cloud = describe(hall(), {});
  const auto salient = std::count_if(cloud.saliency.begin(), cloud.saliency.end(), [](float s) { return s > 0; });
  EXPECT_GT(salient, 20);
  EXPECT_LT(static_cast<std::size_t>(salient), cloud.keypoints.size()) << "flat walls starve on ISS alone";
}

TEST(Describe, TwoKeypointsKeepTheirDistanceAndCoverTheScan) {
  const SampledScan scan = hall();
  FeatureOptions options;
  options.keypoint_spacing_voxels = 3;
  const FeatureCloud cloud = describe(scan, options);
  const float spacing = 3 * 0.2f;
  for (std::size_t a = 0; a < cloud.keypoints.size(); ++a)
    for (std::size_t b = a + 1; b < cloud.keypoints.size(); ++b)
      ASSERT_GE((scan.points[cloud.keypoints[a]] - scan.points[cloud.keypoints[b]]).norm(), spacing * 0.9999f);
  for (std::size_t i = 0; i < scan.points.size(); i += 37) {
    if (scan.variation[i] >= 1) continue;
    float nearest = 1e9f;
    for (const auto k : cloud.keypoints) nearest = std::min(nearest, (scan.points[k] - scan.points[i]).norm());
    EXPECT_LT(nearest, spacing) << "a point without a keypoint nearby";
  }
}

TEST(Describe, MaxKeypointsIsRespectedBySpacingThemOut) {
  const SampledScan scan = hall();
  for (const int most : {50, 300}) {
    FeatureOptions options;
    options.max_keypoints = most;
    const FeatureCloud cloud = describe(scan, options);
    EXPECT_LE(cloud.keypoints.size(), static_cast<std::size_t>(most));
    EXPECT_GT(cloud.keypoints.size(), static_cast<std::size_t>(most) / 2);
  }
}

TEST(Describe, DescriptorsDoNotChangeWhenTheScanIsMoved) {
  const SampledScan scan = hall();
  SampledScan turned = scan;
  const Transform t = pose_of({20, -5, 1}, {1.1, -0.3, 2.2});
  turned.points = testing::moved(scan.points, t);
  for (auto& n : turned.normals) n = (t.linear() * n.cast<double>()).cast<float>();
  const FeatureCloud here = describe(scan, {}), there = describe(turned, {});
  std::size_t common = 0, alike = 0;
  for (std::size_t a = 0; a < here.keypoints.size(); ++a) {
    const auto found = std::lower_bound(there.keypoints.begin(), there.keypoints.end(), here.keypoints[a]);
    if (found == there.keypoints.end() || *found != here.keypoints[a]) continue;
    const auto b = static_cast<std::size_t>(found - there.keypoints.begin());
    double dot = 0;
    for (std::uint32_t k = 0; k < here.dimension; ++k)
      dot += static_cast<double>(here.descriptors[a * here.dimension + k]) *
             static_cast<double>(there.descriptors[b * here.dimension + k]);
    ++common;
    alike += dot > 0.99;
  }
  EXPECT_GT(common, here.keypoints.size() * 9 / 10);
  EXPECT_GT(alike, common * 95 / 100);
  ASSERT_EQ(here.axes.size(), there.axes.size());
  for (const DominantAxis& axis : here.axes) {  // in which order depends on where the station is believed to be
    const Eigen::Vector3d moved = t.linear() * axis.direction.cast<double>();
    EXPECT_TRUE(std::any_of(there.axes.begin(), there.axes.end(), [&](const DominantAxis& other) {
      return std::abs(moved.dot(other.direction.cast<double>())) > 0.9998;
    }));
  }
}

TEST(Describe, AnEmptyScanHasNoFeatures) {
  SampledScan nothing;
  nothing.voxel_m = 0.1;
  const FeatureCloud cloud = describe(nothing, {});
  EXPECT_TRUE(cloud.keypoints.empty());
  EXPECT_TRUE(cloud.descriptors.empty());
  EXPECT_TRUE(cloud.axes.empty());
}

TEST(Describe, PointsWithoutNormalsHaveNoDescriptors) {
  SampledScan scan = hall();
  std::fill(scan.variation.begin(), scan.variation.end(), 1.0f);
  EXPECT_TRUE(describe(scan, {}).keypoints.empty());
}

TEST(Describe, OnePlaneHasOneAxisAndDescriptorsThatAreAllAlike) {
  const FeatureCloud cloud = describe(one_plane(), {});
  ASSERT_GT(cloud.keypoints.size(), 30u);
  EXPECT_EQ(cloud.axes.size(), 1u);
  std::size_t alike = 0;
  for (std::size_t k = 1; k < cloud.keypoints.size(); ++k) {
    double dot = 0;
    for (std::uint32_t b = 0; b < cloud.dimension; ++b)
      dot +=
          static_cast<double>(cloud.descriptors[b]) * static_cast<double>(cloud.descriptors[k * cloud.dimension + b]);
    alike += dot > 0.9;
  }
  EXPECT_GT(alike, cloud.keypoints.size() * 8 / 10);
}

TEST(Describe, TheSameBytesForAnyNumberOfThreads) {
  const SampledScan scan = hall();
  const auto run = [&] { return store::to_bytes(describe(scan, {})); };
  const std::string one = testing::with_threads(1, run);
  EXPECT_EQ(testing::with_threads(2, run), one);
  EXPECT_EQ(testing::with_threads(7, run), one);
}

}  // namespace
}  // namespace isthmus
