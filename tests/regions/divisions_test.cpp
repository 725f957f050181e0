// What holds for every division of the table.
#include "regions/divisions.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "pairwise/synthetic_product.h"
#include "pairwise/threads.h"
#include "regions/partition.h"
#include "regions/patch_scene.h"
#include "store/archive.h"

namespace isthmus {
namespace {

struct Scan {
  SampledScan sampled;
  FeatureCloud features;
};

const Scan& hall() {
  static const Scan scan = [] {
    Scan s;
    s.sampled = testing::sampled(testing::scan_scene(testing::furnished_hall(1), testing::pose_of({0, 0, 1.7})), 0.2);
    s.features = describe(s.sampled, {});
    return s;
  }();
  return scan;
}

// Every point a keypoint on flat ground.
Scan keypoints_at(const testing::Points& points) {
  Scan scan;
  scan.sampled.voxel_m = 0.1;
  scan.sampled.points = points;
  scan.sampled.normals.assign(points.size(), Eigen::Vector3f::UnitZ());
  scan.sampled.variation.assign(points.size(), 0.001f);
  for (std::uint32_t i = 0; i < points.size(); ++i) scan.features.keypoints.push_back(i);
  return scan;
}

class EveryDivision : public ::testing::TestWithParam<Division> {
 protected:
  [[nodiscard]] RegionMap divided(const Scan& scan, int per_region = RegionOptions{}.keypoints_per_region) const {
    RegionOptions options;
    options.division = GetParam().name;
    options.keypoints_per_region = per_region;
    return divide(scan.sampled, scan.features, options);
  }
};

TEST_P(EveryDivision, PutsEveryKeypointIntoExactlyOneRegion) {
  for (const int per_region : {5, 40, 10000}) {
    const RegionMap map = divided(hall(), per_region);
    testing::expect_partition(map, hall().features.keypoints.size());
  }
}

TEST_P(EveryDivision, MakesRegionsOfAboutTheWantedSize) {
  constexpr int kWanted = 40;
  const RegionMap map = divided(hall(), kWanted);
  const double mean = static_cast<double>(hall().features.keypoints.size()) / static_cast<double>(map.regions.size());
  EXPECT_GT(mean, 0.8 * kWanted);
  EXPECT_LT(mean, 1.2 * kWanted);
  std::size_t extreme = 0;
  for (const Region& region : map.regions)
    extreme += region.keypoints.size() > 3 * kWanted || region.keypoints.size() < kWanted / 8;
  EXPECT_LE(extreme, map.regions.size() / 20);
}

TEST_P(EveryDivision, FillsCentreNormalRadiusAndMutualNeighbours) {
  const RegionMap map = divided(hall());
  std::size_t links = 0;
  for (std::uint32_t r = 0; r < map.regions.size(); ++r) {
    const Region& region = map.regions[r];
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    for (const std::uint32_t k : region.keypoints) {
      centre += hall().sampled.points[hall().features.keypoints[k]].cast<double>();
      normal += hall().sampled.normals[hall().features.keypoints[k]].cast<double>();
    }
    const auto n = static_cast<double>(region.keypoints.size());
    EXPECT_LT((region.centre.cast<double>() - centre / n).norm(), 1e-4);
    EXPECT_LT((region.normal.cast<double>() - normal / n).norm(), 1e-4);
    EXPECT_TRUE(std::ranges::is_sorted(region.neighbours));
    for (const std::uint32_t other : region.neighbours) {
      ASSERT_LT(other, map.regions.size());
      EXPECT_NE(other, r);
      EXPECT_TRUE(std::ranges::binary_search(map.regions[other].neighbours, r)) << r << " and " << other;
    }
    links += region.neighbours.size();
  }
  EXPECT_GT(links, map.regions.size());  // a hall is one piece
}

TEST_P(EveryDivision, TakesNoneOneAndTwoKeypoints) {
  EXPECT_TRUE(divided({}).regions.empty());
  const RegionMap one = divided(keypoints_at({{1, 2, 3}}));
  testing::expect_partition(one, 1);
  EXPECT_TRUE(one.regions[0].neighbours.empty());
  EXPECT_EQ(one.regions[0].radius_m, 0);
  EXPECT_LT((one.regions[0].centre - Eigen::Vector3f(1, 2, 3)).norm(), 1e-6f);
  testing::expect_partition(divided(keypoints_at({{1, 2, 3}, {1.1f, 2, 3}})), 2);
  testing::expect_partition(divided(keypoints_at({{1, 2, 3}, {500, 2, 3}})), 2);
}

TEST_P(EveryDivision, TakesEqualCollinearAndCoplanarKeypoints) {
  testing::expect_partition(divided(keypoints_at(testing::Points(200, Eigen::Vector3f(4, 4, 4)))), 200);
  testing::Points line, plane;
  for (int i = 0; i < 200; ++i) line.emplace_back(0.1f * static_cast<float>(i), 0.0f, 0.0f);
  testing::expect_partition(divided(keypoints_at(line)), 200);
  for (int i = 0; i < 400; ++i)
    plane.emplace_back(0.1f * static_cast<float>(i / 20), 0.1f * static_cast<float>(i % 20), 0);
  const RegionMap map = divided(keypoints_at(plane));
  testing::expect_partition(map, 400);
  EXPECT_GE(map.regions.size(), 6U);
  EXPECT_LE(map.regions.size(), 20U);
}

TEST_P(EveryDivision, TakesScansWithoutANormal) {
  Scan scan = keypoints_at(testing::sphere_points(100, {0, 0, 0}, 1, 3));
  scan.sampled.variation.assign(100, 1.0f);
  testing::expect_partition(divided(scan), 100);
}

TEST_P(EveryDivision, KeepsHeapsApart) {
  testing::Points points = testing::sphere_points(80, {0, 0, 0}, 1, 1);
  const testing::Points other = testing::sphere_points(80, {50, 0, 0}, 1, 2);
  points.insert(points.end(), other.begin(), other.end());
  const RegionMap map = divided(keypoints_at(points));
  testing::expect_partition(map, 160);
  for (const Region& region : map.regions) {
    EXPECT_LT(region.radius_m, 3);
    for (const std::uint32_t n : region.neighbours) EXPECT_LT((map.regions[n].centre - region.centre).norm(), 10);
  }
}

TEST_P(EveryDivision, IsTheSameWhereverTheScanLies) {
  Scan moved = hall();
  const Transform motion = testing::pose_of({70, -40, 9}, {0.4, -0.3, 2});
  moved.sampled.points = testing::moved(moved.sampled.points, motion);
  for (Eigen::Vector3f& n : moved.sampled.normals) n = (motion.linear() * n.cast<double>()).cast<float>();
  EXPECT_GT(testing::agreement(divided(hall()), divided(moved)), 0.95);  // rounding decides ties
}

TEST_P(EveryDivision, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto run = [&] { return store::to_bytes(divided(hall())); };
  const std::string one = testing::with_threads(1, run);
  EXPECT_EQ(testing::with_threads(2, run), one);
  EXPECT_EQ(testing::with_threads(7, run), one);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryDivision, ::testing::ValuesIn(divisions().begin(), divisions().end()),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(Divisions, AreTheChoicesOfTheOption) {
  std::set<std::string> names;
  for (const Division& division : divisions()) EXPECT_TRUE(names.insert(std::string(division.name)).second);
  EXPECT_GE(names.size(), 4U);
  EXPECT_TRUE(names.contains(RegionOptions{}.division));
  const auto& row = region_options_table().rows.front();
  EXPECT_EQ(std::set<std::string>(row.choices.begin(), row.choices.end()), names);
  for (const std::string& name : names) EXPECT_NE(row.help.find(name + " = "), std::string::npos);
}

TEST(Divisions, RefuseAnUnknownName) {
  RegionOptions options;
  options.division = "slices";
  EXPECT_THROW(divide({}, {}, options), std::invalid_argument);
}

RegionMap divided(const testing::PatchScene& scene, const char* division) {
  RegionOptions options;
  options.division = division;
  return divide(scene.scan, scene.features, options);
}

TEST(DivideByPlanes, SeparatesFacesEdgesAndTheRest) {
  const testing::PatchScene scene;
  const RegionMap map = divided(scene, "planes");
  testing::expect_partition(map, scene.features.keypoints.size());
  constexpr float kAtEdge = 2 * testing::PatchScene::kVoxel, kOffEdge = 3 * testing::PatchScene::kVoxel;
  std::size_t at_edges = 0;
  for (const Region& region : map.regions) {
    std::set<int> surfaces;
    bool edge = false, off = false;
    for (const std::uint32_t k : region.keypoints) {
      surfaces.insert(scene.surface[k]);
      if (scene.surface[k] == testing::PatchScene::kBush) continue;
      const float nearest = scene.to_other_faces_m(k)[0];
      edge |= nearest < kAtEdge;
      off |= nearest > kOffEdge;
    }
    EXPECT_FALSE(edge && off) << "an edge reaches into a face";
    EXPECT_TRUE(surfaces.size() == 1 || !surfaces.contains(testing::PatchScene::kBush));
    EXPECT_TRUE(surfaces.size() == 1 || !off) << "two faces in one region away from their edge";
    EXPECT_TRUE(surfaces.size() >= 2 || !edge) << "an edge has two sides";
    at_edges += edge;
  }
  EXPECT_GE(at_edges, 3U);
}

TEST(DivideByDifferences, StopsAtCreases) {
  const testing::PatchScene scene;
  const RegionMap map = divided(scene, "differences");
  testing::expect_partition(map, scene.features.keypoints.size());
  for (const Region& region : map.regions)
    for (const std::uint32_t k : region.keypoints) EXPECT_EQ(scene.surface[k], scene.surface[region.keypoints[0]]);
}

TEST(DivideByDifferences, FollowsASmoothBendThatPlanesCut) {
  // A quarter of a cylinder of 2 m radius: neighbouring normals turn by 3 degrees.
  Scan scan;
  scan.sampled.voxel_m = 0.1;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 10; ++j) {
      const double angle = i * 0.052;
      const Eigen::Vector3d n(std::cos(angle), std::sin(angle), 0);
      scan.features.keypoints.push_back(static_cast<std::uint32_t>(scan.sampled.points.size()));
      scan.sampled.points.push_back((2 * n + Eigen::Vector3d(0, 0, 0.1 * j)).cast<float>());
      scan.sampled.normals.push_back(n.cast<float>());
      scan.sampled.variation.push_back(0.002f);
    }
  RegionOptions options;
  options.keypoints_per_region = 10000;  // one region unless a boundary says otherwise; small ones join
  options.division = "differences";
  EXPECT_EQ(divide(scan.sampled, scan.features, options).regions.size(), 1U);
  options.keypoints_per_region = 200;  // as many as a patch may hold before its size splits it
  options.division = "planes";
  EXPECT_GT(divide(scan.sampled, scan.features, options).regions.size(), 1U);
}

TEST(DivideBySpectrum, CutsWhereKeypointsHangTogetherLeast) {
  // Two squares of 8 x 8 keypoints, joined by a bridge of one row: the cut is on the bridge, not through a square.
  testing::Points points;
  constexpr int kSide = 8, kBridge = 6;
  for (int square = 0; square < 2; ++square)
    for (int i = 0; i < kSide * kSide; ++i)
      points.emplace_back(0.2f * static_cast<float>(i % kSide + square * (kSide + kBridge)),
                          0.2f * static_cast<float>(i / kSide), 0.0f);
  for (int i = 0; i < kBridge; ++i) points.emplace_back(0.2f * static_cast<float>(kSide + i), 0.8f, 0.0f);
  const Scan scan = keypoints_at(points);
  RegionOptions options;
  options.division = "spectral";
  options.keypoints_per_region = 67;
  const RegionMap map = divide(scan.sampled, scan.features, options);
  ASSERT_EQ(map.regions.size(), 2U);
  for (std::size_t k = 0; k < 2 * kSide * kSide; ++k)
    EXPECT_EQ(map.region_of_keypoint[k], map.region_of_keypoint[k < kSide * kSide ? 0 : kSide * kSide]);
  EXPECT_NE(map.region_of_keypoint[0], map.region_of_keypoint[kSide * kSide]);
}

}  // namespace
}  // namespace isthmus
