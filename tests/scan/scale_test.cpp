// The voxel that follows from the scans.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scan/sample_points.h"

namespace isthmus {
namespace {

using testing::chunk_of;
using testing::furnished_hall;
using testing::pose_of;
using testing::scan_scene;
using Points = testing::Points;

Points hall_points(std::size_t rays = 40000) {
  return scan_scene(furnished_hall(5), pose_of({0, 0, 1.7}), {rays, 1e6, 0.002, 3});
}

Points scaled(Points points, float factor) {
  for (auto& p : points) p *= factor;
  return points;
}

TEST(Scale, TheVoxelKeepsAboutTheWantedNumberOfPoints) {
  const Points points = hall_points(100000);
  for (const int target : {2000, 6000, 20000}) {
    const auto scale = scale_of_probe(chunk_of(points), points.size(), target);
    ASSERT_TRUE(scale);
    const SampledScan scan = testing::sampled(points, scale->voxel_m);
    EXPECT_NEAR(std::log(static_cast<double>(scan.points.size()) / target), 0, std::log(1.25)) << target;
  }
}

TEST(Scale, AProbeOfAFewPointsSaysTheSameAsAllOfThem) {
  const Points points = hall_points(100000);
  Points probe;
  for (std::size_t i = 0; i < points.size(); i += 11) probe.push_back(points[i]);
  const auto whole = scale_of_probe(chunk_of(points), points.size(), 6000),
             part = scale_of_probe(chunk_of(probe), points.size(), 6000);
  ASSERT_TRUE(whole && part);
  EXPECT_NEAR(std::log(part->voxel_m / whole->voxel_m), 0, std::log(1.3));
  EXPECT_EQ(part->spacing_m, 0) << "the spacing of a probe is not that of the scan";
  EXPECT_NEAR(part->extent_m, whole->extent_m, 0.05 * whole->extent_m);
}

TEST(Scale, AThousandTimesTheSceneIsAThousandTimesTheVoxel) {
  const Points points = hall_points();
  const auto one = scale_of_probe(chunk_of(points), points.size(), 8000);
  const auto thousand = scale_of_probe(chunk_of(scaled(points, 1000)), points.size(), 8000);
  const auto thousandth = scale_of_probe(chunk_of(scaled(points, 0.001f)), points.size(), 8000);
  ASSERT_TRUE(one && thousand && thousandth);
  EXPECT_NEAR(thousand->voxel_m / one->voxel_m, 1000, 20);
  EXPECT_NEAR(thousandth->voxel_m / one->voxel_m, 0.001, 2e-5);
  const std::vector<ScanScale> small{*one}, large{*thousand};
  const double ratio = automatic_voxel_m(large) / automatic_voxel_m(small);
  EXPECT_GT(ratio, 750);  // rounding to the series may move either by one step
  EXPECT_LT(ratio, 1300);
}

TEST(Scale, WhatFloatsInTheAirDoesNotWidenTheVoxel) {
  const Points points = hall_points(100000);
  const double clean = scale_of_probe(chunk_of(points), points.size(), 6000)->voxel_m;
  for (const double share : {0.1, 0.3, 0.5}) {
    const Points cluttered = testing::with_clutter(points, share);
    const auto scale = scale_of_probe(chunk_of(cluttered), cluttered.size(), 6000);
    ASSERT_TRUE(scale);
    EXPECT_NEAR(std::log(scale->voxel_m / clean), 0, std::log(1.3)) << share;
    EXPECT_NEAR(scale->extent_m, scale_of_probe(chunk_of(points), points.size(), 6000)->extent_m,
                0.2 * scale->extent_m);
  }
}

TEST(Scale, MarksOfMissingDataDoNotCount) {
  Points points = hall_points();
  const auto clean = scale_of_probe(chunk_of(points), points.size(), 6000);
  for (std::size_t i = 0; i < points.size(); i += 40)
    points.insert(points.begin() + static_cast<std::ptrdiff_t>(i), {-1e30f, -1e30f, -1e30f});
  const auto marked = scale_of_probe(chunk_of(points), points.size(), 6000);
  ASSERT_TRUE(clean && marked);
  EXPECT_NEAR(std::log(marked->voxel_m / clean->voxel_m), 0, std::log(1.05));
}

TEST(Scale, TheVoxelIsNotFinerThanTheNoise) {
  const double clean = scale_of_probe(chunk_of(hall_points()), 40000, 15000)->voxel_m;
  for (const double noise_m : {0.01, 0.2, 0.4}) {
    const Points points = scan_scene(furnished_hall(5), pose_of({0, 0, 1.7}), {40000, 1e6, noise_m, 3});
    const double voxel_m = scale_of_probe(chunk_of(points), points.size(), 15000)->voxel_m;
    if (1.5 * noise_m < clean)
      EXPECT_NEAR(std::log(voxel_m / clean), 0, std::log(1.15)) << noise_m;
    else
      EXPECT_NEAR(std::log(voxel_m / (1.5 * noise_m)), 0, std::log(1.4)) << noise_m;
  }
}

TEST(Scale, TheVoxelOfASurveyDoesNotDependOnTheOrderOfItsScans) {
  std::vector<ScanScale> scales;
  Rng rng(7);
  for (int k = 0; k < 9; ++k) scales.push_back({rng.uniform(0.05, 0.4), k % 3 ? 0.0 : rng.uniform(0.01, 0.3), 10});
  const double voxel = automatic_voxel_m(scales);
  for (int k = 0; k < 30; ++k) {
    for (std::size_t i = scales.size() - 1; i > 0; --i) std::swap(scales[i], scales[rng.below(i + 1)]);
    EXPECT_EQ(automatic_voxel_m(scales), voxel);
  }
}

TEST(Scale, OneStrangeScanDoesNotMoveTheVoxel) {
  std::vector<ScanScale> scales;
  for (int k = 0; k < 10; ++k) scales.push_back({0.1 + 0.001 * k, 0, 20});
  const double voxel = automatic_voxel_m(scales);
  for (const double strange : {1e-4, 50.0}) {
    auto with = scales;
    with.push_back({strange, 0, 20});
    EXPECT_EQ(automatic_voxel_m(with), voxel);
  }
}

TEST(Scale, TheVoxelIsNotFinerThanTheRawPoints) {
  const std::vector<ScanScale> sparse{{0.1, 0.5, 30}, {0.1, 0.5, 30}, {0.1, 0.5, 30}};
  EXPECT_NEAR(std::log10(automatic_voxel_m(sparse) / 0.5), 0, 0.051);
}

TEST(Scale, UselessProbesAreErrors) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(scale_of_probe({}, 0, 1000));
  EXPECT_FALSE(scale_of_probe(chunk_of(Points(500, Eigen::Vector3f(nan, nan, nan))), 500, 1000));
  EXPECT_FALSE(scale_of_probe(chunk_of(Points(500, Eigen::Vector3f::Zero())), 500, 1000));
  const auto same = scale_of_probe(chunk_of(Points(500, Eigen::Vector3f(3, 2, 1))), 500, 1000);
  ASSERT_FALSE(same);
  EXPECT_NE(same.error().what.find("same"), std::string::npos);
  EXPECT_FALSE(same.error().hint.empty());
}

}  // namespace
}  // namespace isthmus
