#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "scan/sample_points.h"
#include "store/archive.h"

namespace isthmus {
namespace {

using testing::furnished_hall;
using testing::pose_of;
using testing::sampled;
using testing::SamplingSetup;
using testing::scan_scene;
using testing::station_option;
using testing::try_sampling;
using Points = testing::Points;

const float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

Points hall_scan(std::size_t rays = 30000) {
  return scan_scene(furnished_hall(1), pose_of({0, 0, 1.7}), {rays, 1e6, 0.003, 5});
}

// Five by five voxels of 1 m, each with the points (1/4, 1/4, 1/4) and (3/4, 1/2, 1/2) of it.
Points two_points_a_voxel() {
  Points points;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      points.emplace_back(fx + 0.25f, fy + 0.25f, 0.25f);
      points.emplace_back(fx + 0.75f, fy + 0.5f, 0.5f);
    }
  return points;
}

TEST(VoxelSampler, CentroidsAndCountsByHandSortedByVoxel) {
  const SampledScan scan = sampled(two_points_a_voxel(), 1.0, station_option("unknown"));
  ASSERT_EQ(scan.points.size(), 25u);
  std::size_t k = 0;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y, ++k) {
      const Eigen::Vector3f expected(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.375f, 0.375f);
      EXPECT_LT((scan.points[k] - expected).norm(), 1e-6f) << scan.points[k].transpose();
      EXPECT_EQ(scan.counts[k], 2u);
      EXPECT_GT(std::abs(scan.normals[k].z()), 0.8f);
      EXPECT_NEAR(scan.normals[k].norm(), 1, 1e-5);
    }
  EXPECT_EQ(scan.num_read, 50u);
  EXPECT_EQ(scan.num_dropped, 0u);
  EXPECT_EQ(scan.voxel_m, 1.0);
  EXPECT_EQ(scan.variation.size(), 25u);
}

TEST(VoxelSampler, TheSameBytesForAnyChunkSize) {
  const Points points = hall_scan();
  SamplingSetup setup;
  const std::string whole = store::to_bytes(sampled(points, 0.2, setup));
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{7}, std::size_t{1000}, points.size()}) {
    setup.chunk = chunk;
    EXPECT_EQ(store::to_bytes(sampled(points, 0.2, setup)), whole) << "chunks of " << chunk;
  }
}

TEST(VoxelSampler, UselessPointsAreDroppedAndCountedAndDoNoHarm) {
  const Points clean = hall_scan();
  Points dirty;
  std::size_t useless = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    dirty.push_back(clean[i]);
    if (i % 10 != 3) continue;
    const Points bad{{kNan, 0, 0}, {0, kInf, 1}, {1, 2, -kInf}, {0, 0, 0}, {1e30f, 0, 0}, {-1e12f, 5, 5}};
    dirty.insert(dirty.end(), bad.begin(), bad.end());
    useless += bad.size();
  }
  SampledScan a = sampled(clean, 0.2), b = sampled(dirty, 0.2);
  EXPECT_EQ(b.num_read, a.num_read + useless);
  EXPECT_EQ(b.num_dropped, a.num_dropped + useless);
  b.num_read = a.num_read, b.num_dropped = a.num_dropped;
  EXPECT_EQ(store::to_bytes(a), store::to_bytes(b));
}

TEST(VoxelSampler, EveryPointReadIsKeptOrCountedAsDropped) {
  const SampledScan scan = sampled(hall_scan(), 0.2);
  std::uint64_t kept = 0;
  for (const auto n : scan.counts) kept += n;
  EXPECT_EQ(kept + scan.num_dropped, scan.num_read);
}

TEST(VoxelSampler, AStrayPointInTheAirIsNoSurface) {
  Points points = hall_scan();
  const std::size_t before = sampled(points, 0.2).points.size();
  Eigen::Vector3f stray = Eigen::Vector3f::Zero();  // the point half way to a surface that has most air around it
  float most_air = 0;
  for (std::size_t i = 0; i < points.size(); i += 500) {
    const Eigen::Vector3f middle = 0.5f * points[i];
    float air = std::numeric_limits<float>::infinity();
    for (const auto& p : points) air = std::min(air, (p - middle).norm());
    if (air > most_air) most_air = air, stray = middle;
  }
  ASSERT_GT(most_air, 1.0f);
  points.push_back(stray);
  const SampledScan scan = sampled(points, 0.2);
  EXPECT_EQ(scan.points.size(), before);
  for (const auto& p : scan.points) EXPECT_GT((p - stray).norm(), 0.9f);
}

TEST(VoxelSampler, AFarLocalOriginChangesNothingButTheOrigin) {
  const Eigen::Vector3d far(500000.25, 5240000.5, 431);
  const Points points = hall_scan();
  SamplingSetup near_setup, far_setup;
  near_setup.header.station_in_scan = Eigen::Vector3d::Zero();
  far_setup.header.local_origin_in_scan = far;
  far_setup.header.station_in_scan = far;
  SampledScan near_scan = sampled(points, 0.2, near_setup), far_scan = sampled(points, 0.2, far_setup);
  EXPECT_EQ(far_scan.local_origin_in_scan, far);
  EXPECT_EQ(far_scan.station_kind, StationKind::origin);
  EXPECT_TRUE(far_scan.station.isZero());
  far_scan.local_origin_in_scan.setZero();
  EXPECT_EQ(store::to_bytes(far_scan), store::to_bytes(near_scan));
}

TEST(VoxelSampler, MapCoordinatesWithoutAStationHaveNoFreeSpace) {
  SamplingSetup setup;
  setup.header.local_origin_in_scan = Eigen::Vector3d(500000, 5240000, 431);
  const SampledScan scan = sampled(hall_scan(), 0.2, setup);
  EXPECT_EQ(scan.station_kind, StationKind::unknown);
  EXPECT_EQ(scan.free_space.size, 0u);
}

TEST(VoxelSampler, TooFewVoxelsIsAnErrorThatSaysHowMany) {
  Points nine;
  for (int i = 0; i < 9; ++i)
    nine.emplace_back(static_cast<float>(i % 3) + 0.5f, static_cast<float>(i / 3) + 0.5f, 0.2f);
  const auto few = try_sampling(nine, 1.0);
  ASSERT_FALSE(few);
  EXPECT_NE(few.error().what.find("9 voxels"), std::string::npos) << few.error().text();
  EXPECT_FALSE(few.error().hint.empty());
  EXPECT_FALSE(try_sampling({}, 1.0));
  EXPECT_FALSE(try_sampling(Points(5000, Eigen::Vector3f(1, 2, 3)), 0.1)) << "5000 times the same point";
  EXPECT_FALSE(try_sampling(Points(100, Eigen::Vector3f(kNan, kNan, kNan)), 0.1));
}

TEST(VoxelSampler, FinishIsCalledOnce) {
  VoxelSampler sampler({}, 0.2, {});
  sampler.add(testing::chunk_of(hall_scan()));
  EXPECT_TRUE(sampler.finish());
  EXPECT_FALSE(sampler.finish());
}

TEST(VoxelSampler, MemoryGrowsWithVoxelsNotWithPoints) {
  VoxelSampler sampler({}, 0.2, {});
  const PointChunk chunk = testing::chunk_of(hall_scan());
  sampler.add(chunk);
  const std::size_t once = sampler.bytes();
  for (int again = 0; again < 20; ++again) sampler.add(chunk);
  EXPECT_EQ(sampler.bytes(), once);
}

TEST(VoxelSampler, TheFineLevelLiesInTheCoarseVoxels) {
  constexpr double kVoxel = 0.3;
  const SampledScan scan = sampled(hall_scan(400000), kVoxel);
  ASSERT_GT(scan.fine.points.size(), scan.points.size());
  ASSERT_EQ(scan.fine.normals.size(), scan.fine.points.size());
  ASSERT_EQ(scan.fine.variation.size(), scan.fine.points.size());
  const double ratio = kVoxel / scan.fine.voxel_m;
  EXPECT_GE(ratio, 2);
  EXPECT_NEAR(ratio, std::round(ratio), 1e-9);
  const auto cell = [](const Eigen::Vector3f& p, double edge) {
    return std::array<int, 3>{static_cast<int>(std::floor(p.x() / edge)), static_cast<int>(std::floor(p.y() / edge)),
                              static_cast<int>(std::floor(p.z() / edge))};
  };
  std::set<std::array<int, 3>> coarse, fine;
  for (const auto& p : scan.points) coarse.insert(cell(p, kVoxel));
  EXPECT_EQ(coarse.size(), scan.points.size()) << "one point a voxel";
  std::size_t inside = 0;
  for (const auto& p : scan.fine.points)
    inside += coarse.count(cell(p, kVoxel)), fine.insert(cell(p, scan.fine.voxel_m));
  EXPECT_EQ(fine.size(), scan.fine.points.size()) << "one point a fine voxel";
  EXPECT_GT(inside, scan.fine.points.size() * 995 / 1000);  // a coarse voxel alone in the air may be left out
}

TEST(VoxelSampler, ASparseScanHasNoFineLevel) {
  const SampledScan scan = sampled(hall_scan(6000), 0.3);
  EXPECT_TRUE(scan.fine.points.empty());
}

TEST(VoxelSampler, SpacingFollowsTheDensityOfThePoints) {
  const double sparse = sampled(hall_scan(20000), 0.5).spacing_m, dense = sampled(hall_scan(80000), 0.5).spacing_m;
  EXPECT_NEAR(sparse / dense, 2, 0.4);
}

}  // namespace
}  // namespace isthmus
