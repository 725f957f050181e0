#include "regions/divide.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pairwise/synthetic_product.h"
#include "pairwise/threads.h"
#include "store/archive.h"

namespace isthmus {
namespace {

struct Scan {
  SampledScan sampled;
  FeatureCloud features;
};

Scan hall() {
  Scan scan;
  scan.sampled = testing::sampled(testing::scan_scene(testing::furnished_hall(1), testing::pose_of({0, 0, 1.7})), 0.2);
  scan.features = describe(scan.sampled, {});
  return scan;
}

Scan keypoints_at(const testing::Points& points) {
  Scan scan;
  scan.sampled.voxel_m = 0.1;
  scan.sampled.points = points;
  scan.sampled.normals.assign(points.size(), Eigen::Vector3f::UnitZ());
  for (std::uint32_t i = 0; i < points.size(); ++i) scan.features.keypoints.push_back(i);
  return scan;
}

void expect_partition(const RegionMap& map, std::size_t num_keypoints) {
  ASSERT_EQ(map.region_of_keypoint.size(), num_keypoints);
  std::vector<int> members(num_keypoints, 0);
  for (std::uint32_t r = 0; r < map.regions.size(); ++r) {
    EXPECT_FALSE(map.regions[r].keypoints.empty());
    EXPECT_TRUE(std::is_sorted(map.regions[r].keypoints.begin(), map.regions[r].keypoints.end()));
    for (const std::uint32_t k : map.regions[r].keypoints) {
      ASSERT_LT(k, num_keypoints);
      ++members[k];
      EXPECT_EQ(map.region_of_keypoint[k], r);
    }
  }
  EXPECT_EQ(std::count(members.begin(), members.end(), 1), static_cast<std::ptrdiff_t>(num_keypoints));
}

TEST(Divide, EveryKeypointBelongsToExactlyOneRegion) {
  const Scan scan = hall();
  for (const int per_region : {5, 40, 100000}) {
    const RegionMap map = divide(scan.sampled, scan.features, {"clusters", per_region});
    expect_partition(map, scan.features.keypoints.size());
    if (per_region == 100000) {
      EXPECT_EQ(map.regions.size(), 1u);
    } else {
      const double wanted = static_cast<double>(scan.features.keypoints.size()) / per_region;
      EXPECT_GT(static_cast<double>(map.regions.size()), 0.8 * wanted);
      EXPECT_LE(static_cast<double>(map.regions.size()), 1.01 * wanted + 1);
    }
  }
}

TEST(Divide, NeighboursAreMutualSortedAndNear) {
  const Scan scan = hall();
  const RegionMap map = divide(scan.sampled, scan.features, {});
  std::size_t links = 0;
  for (std::uint32_t a = 0; a < map.regions.size(); ++a) {
    const auto& neighbours = map.regions[a].neighbours;
    EXPECT_TRUE(std::is_sorted(neighbours.begin(), neighbours.end()));
    for (const std::uint32_t b : neighbours) {
      ASSERT_LT(b, map.regions.size());
      EXPECT_NE(a, b);
      const auto& back = map.regions[b].neighbours;
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), a)) << a << " and " << b;
    }
    links += neighbours.size();
  }
  EXPECT_GT(links, map.regions.size());  // a hall is one piece
}

TEST(Divide, CentreNormalAndRadiusAreThoseOfTheKeypoints) {
  const Scan scan = hall();
  for (const Region& region : divide(scan.sampled, scan.features, {}).regions) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    float radius = 0;
    for (const std::uint32_t k : region.keypoints) {
      centre += scan.sampled.points[scan.features.keypoints[k]].cast<double>();
      normal += scan.sampled.normals[scan.features.keypoints[k]].cast<double>();
    }
    const auto n = static_cast<double>(region.keypoints.size());
    EXPECT_LT((region.centre.cast<double>() - centre / n).norm(), 1e-4);
    EXPECT_LT((region.normal.cast<double>() - normal / n).norm(), 1e-4);
    for (const std::uint32_t k : region.keypoints)
      radius = std::max(radius, (scan.sampled.points[scan.features.keypoints[k]] - region.centre).norm());
    EXPECT_NEAR(region.radius_m, radius, 1e-4);
  }
}

TEST(Divide, RegionsAreCompact) {
  const Scan scan = hall();
  const RegionMap map = divide(scan.sampled, scan.features, {});
  std::size_t nearest_is_own = 0;
  for (std::size_t k = 0; k < map.region_of_keypoint.size(); ++k) {
    const Eigen::Vector3f& p = scan.sampled.points[scan.features.keypoints[k]];
    const float own = (p - map.regions[map.region_of_keypoint[k]].centre).norm();
    nearest_is_own += std::all_of(map.regions.begin(), map.regions.end(),
                                  [&](const Region& r) { return (p - r.centre).norm() >= own * 0.999f; });
  }
  EXPECT_GT(nearest_is_own, map.region_of_keypoint.size() * 9 / 10);
}

TEST(Divide, NoneOneAndEqualKeypoints) {
  EXPECT_TRUE(divide({}, {}, {}).regions.empty());
  const Scan one = keypoints_at({{1, 2, 3}});
  const RegionMap map = divide(one.sampled, one.features, {});
  expect_partition(map, 1);
  EXPECT_TRUE(map.regions[0].neighbours.empty());
  EXPECT_LT((map.regions[0].centre - Eigen::Vector3f(1, 2, 3)).norm(), 1e-6f);
  const Scan equal = keypoints_at(testing::Points(200, Eigen::Vector3f(4, 4, 4)));
  expect_partition(divide(equal.sampled, equal.features, {}), 200);
}

TEST(Divide, TwoHeapsAreNotMixed) {
  testing::Points points = testing::sphere_points(80, {0, 0, 0}, 1, 1);
  const testing::Points other = testing::sphere_points(80, {50, 0, 0}, 1, 2);
  points.insert(points.end(), other.begin(), other.end());
  const Scan scan = keypoints_at(points);
  const RegionMap map = divide(scan.sampled, scan.features, {"clusters", 40});
  expect_partition(map, 160);
  for (const Region& region : map.regions) {
    EXPECT_LT(region.radius_m, 3);
    for (const std::uint32_t n : region.neighbours) EXPECT_LT((map.regions[n].centre - region.centre).norm(), 10);
  }
}

TEST(Divide, TheSameBytesForAnyNumberOfThreads) {
  const Scan scan = hall();
  const auto run = [&] { return store::to_bytes(divide(scan.sampled, scan.features, {})); };
  const std::string one = testing::with_threads(1, run);
  EXPECT_EQ(testing::with_threads(7, run), one);
}

}  // namespace
}  // namespace isthmus
