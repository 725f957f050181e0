#include "scan/station.h"

#include <gtest/gtest.h>

#include "scan/sample_points.h"

namespace isthmus {
namespace {

using testing::chunk_of;
using testing::furnished_hall;
using testing::moved;
using testing::pose_of;
using testing::sampled;
using testing::SamplingSetup;
using testing::scan_scene;
using testing::Scene;
using testing::station_option;
using Points = testing::Points;

TEST(Station, TheOriginOfARoomScanIsBelieved) {
  const SampledScan scan = sampled(scan_scene(furnished_hall(2), pose_of({1, 0.5, 1.7})), 0.2);
  EXPECT_EQ(scan.station_kind, StationKind::origin);
  EXPECT_TRUE(scan.station.isZero());
  EXPECT_GT(scan.free_space.size, 0u);
  EXPECT_EQ(scan.free_space.nearest_m.size(), 6u * scan.free_space.size * scan.free_space.size);
  EXPECT_LT(scan.blocked_share, 0.25);
}

TEST(Station, TheFilesOwnStationIsUsedWhereverItLies) {
  const Transform elsewhere = pose_of({30, -12, 4}, {0, 0, 1});
  SamplingSetup setup;
  setup.header.station_in_scan = elsewhere.translation();
  const SampledScan scan = sampled(moved(scan_scene(furnished_hall(2), pose_of({1, 0.5, 1.7})), elsewhere), 0.2, setup);
  EXPECT_EQ(scan.station_kind, StationKind::origin);
  EXPECT_LT((scan.station.cast<double>() - elsewhere.translation()).norm(), 1e-4);
  for (std::size_t i = 0; i < scan.points.size(); ++i) EXPECT_GE(scan.normals[i].dot(scan.station - scan.points[i]), 0);
}

// Most of what was scanned from outside lies behind the walls of a small room around the origin.
TEST(Station, AnOriginBehindWallsIsNotBelieved) {
  Scene nested;
  nested.add_box({0, 0, 0}, {2.5, 2.5, 2.5});
  nested.add_box({0, 0, 0}, {14, 14, 10});
  Points points = scan_scene(nested, pose_of({0, 0, 0}), {20000, 1e6, 0, 1});
  const Points outside = moved(scan_scene(nested, pose_of({5, 5, 3}), {60000, 1e6, 0, 2}), pose_of({5, 5, 3}));
  points.insert(points.end(), outside.begin(), outside.end());
  const SampledScan scan = sampled(points, 0.2);
  EXPECT_EQ(scan.station_kind, StationKind::unknown);
  EXPECT_EQ(scan.free_space.size, 0u);
  EXPECT_FALSE(scan.notes.empty());
}

// A single view of an object in a frame of its own: the camera stood far from the origin.
Points object_seen_from_elsewhere() {
  Scene object;
  object.add_box({0, 0, 0.05}, {0.10, 0.06, 0.10}, rotation_from_vector({0, 0, 0.4}));
  object.add_box({0.05, 0.02, 0.12}, {0.04, 0.05, 0.06}, rotation_from_vector({0.3, 0.2, 0.1}));
  const Transform world_from_camera = pose_of({0.25, -0.3, 0.25});
  return moved(scan_scene(object, world_from_camera, {600000, 1, 0, 1}), world_from_camera);
}

TEST(Station, AnObjectsOriginIsNotTheCamera) {
  const Points points = object_seen_from_elsewhere();
  ASSERT_GT(points.size(), 3000u);
  for (const Eigen::Vector3d& frame : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.02, -0.1, 0.01)}) {
    const SampledScan scan = sampled(moved(points, pose_of(frame)), 0.004);
    EXPECT_EQ(scan.station_kind, StationKind::unknown) << frame.transpose();
    EXPECT_EQ(scan.free_space.size, 0u);
  }
}

// Programs shift clouds to their mean: the origin then lies among the points, but not where the scanner stood.
TEST(Station, ACentredCloudHasAStationWithinSomeMetresOnly) {
  Points points = scan_scene(furnished_hall(2), pose_of({1, 0.5, 1.7}));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p.cast<double>();
  mean /= static_cast<double>(points.size());
  const SampledScan scan = sampled(moved(points, pose_of(-mean)), 0.2);
  EXPECT_EQ(scan.station_kind, StationKind::estimated);
  EXPECT_GT(scan.station_sigma_m, 0.05);
  EXPECT_GT(scan.free_space.size, 0u);
  EXPECT_EQ(sampled(points, 0.2).station_sigma_m, 0);
}

TEST(Station, TheUserHasTheLastWord) {
  const Points room = scan_scene(furnished_hall(2), pose_of({1, 0.5, 1.7}));
  EXPECT_EQ(sampled(room, 0.2, station_option("unknown")).station_kind, StationKind::unknown);
  EXPECT_EQ(sampled(object_seen_from_elsewhere(), 0.004, station_option("origin")).station_kind, StationKind::origin);
}

TEST(Station, CheckByHand) {
  // A wall of 21 x 21 voxels 10 m in front of the station, and half of it again 4 m in front: lines to the far half are
  // blocked, save those that slip between two points.
  Points points;
  std::vector<Eigen::Vector3f> normals;
  const auto add_wall = [&](float distance, int from) {
    for (int y = from; y <= 10; ++y)
      for (int z = -10; z <= 10; ++z) {
        points.emplace_back(distance, 0.04f * distance * static_cast<float>(y),
                            0.04f * distance * static_cast<float>(z));
        normals.push_back(Eigen::Vector3f::UnitX());
      }
  };
  add_wall(10, -10);
  const StationCheck open = SightLines(points, normals, 0.4f).from(Eigen::Vector3f::Zero());
  EXPECT_EQ(open.blocked, 0);
  EXPECT_GT(open.concentration, 0.9);
  EXPECT_NEAR(open.median_range_m, 10, 1);
  add_wall(4, 1);
  const StationCheck half = SightLines(points, normals, 0.4f).from(Eigen::Vector3f::Zero());
  EXPECT_LE(half.blocked, 210.0 / 651.0);
  EXPECT_GT(half.blocked, 0.5 * 210.0 / 651.0);
  const StationCheck nothing = SightLines({}, {}, 0.4f).from(Eigen::Vector3f::Zero());
  EXPECT_EQ(nothing.blocked, 1);
}

}  // namespace
}  // namespace isthmus
