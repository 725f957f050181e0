#include "scan/surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scan/sample_points.h"

namespace isthmus {
namespace {

using testing::empty_room;
using testing::pose_of;
using testing::sampled;
using testing::scan_scene;
using testing::sphere_points;
using testing::station_option;
using Points = testing::Points;

std::vector<VoxelMoments> bare(const Points& points) {
  std::vector<VoxelMoments> out;
  for (const auto& p : points) out.push_back({p, Eigen::Matrix3f::Zero()});
  return out;
}

Points square_of_points(int n, const Eigen::Matrix3d& turn) {
  Points points;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y) points.push_back((turn * Eigen::Vector3d(x, y, 0)).cast<float>());
  return points;
}

TEST(Surface, APlaneHasItsNormalAndNoVariation) {
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, -0.4, 2), Eigen::Vector3d(1.5708, 0, 0)}) {
    const Eigen::Matrix3d r = rotation_from_vector(turn);
    const SurfaceEstimate surface = estimate_surface(bare(square_of_points(9, r)), 1.0f);
    const Eigen::Vector3f normal = r.col(2).cast<float>();
    for (std::size_t i = 0; i < surface.normals.size(); ++i) {
      EXPECT_GT(std::abs(surface.normals[i].dot(normal)), 0.9999f);
      EXPECT_LT(surface.variation[i], 1e-4f);
    }
  }
}

TEST(Surface, ALineAndALonePointDetermineNoNormal) {
  Points points;
  for (int i = 0; i < 20; ++i) points.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  points.emplace_back(0.0f, 500.0f, 0.0f);
  const SurfaceEstimate surface = estimate_surface(bare(points), 1.0f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(surface.variation[i], 1.0f);
    EXPECT_NEAR(surface.normals[i].norm(), 1, 1e-5);
  }
  EXPECT_EQ(surface.neighbours.back(), 1u);
}

// Rings of a spinning scanner: two lines three voxels apart only make a surface together.
TEST(Surface, TheRadiusGrowsWhereNeighboursLieOnALine) {
  Points points;
  for (int ring = 0; ring < 4; ++ring)
    for (int i = 0; i < 20; ++i) points.emplace_back(static_cast<float>(i), 3.0f * static_cast<float>(ring), 0.0f);
  const SurfaceEstimate surface = estimate_surface(bare(points), 1.0f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT(surface.variation[i], 1e-3f);
    EXPECT_GT(std::abs(surface.normals[i].z()), 0.999f);
  }
}

TEST(Surface, NormalsOfARoomFaceTheStationAndItsAxes) {
  const SampledScan scan = sampled(scan_scene(empty_room({8, 6, 3}), pose_of({0.5, -0.7, 0.2})), 0.15);
  ASSERT_EQ(scan.station_kind, StationKind::origin);
  std::size_t along_axis = 0, flat = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    EXPECT_GE(scan.normals[i].dot(scan.station - scan.points[i]), 0);
    if (scan.variation[i] > 1e-3f) continue;  // edges of the room
    ++flat;
    along_axis += scan.normals[i].cwiseAbs().maxCoeff() > 0.9998f;
  }
  EXPECT_GT(flat, scan.points.size() * 6 / 10);
  EXPECT_GT(along_axis, flat * 995 / 1000);
}

TEST(Surface, FineNormalsFaceTheStationToo) {
  const SampledScan scan = sampled(scan_scene(empty_room({8, 6, 3}), pose_of({0, 0, 0}), {120000, 1e6, 0, 1}), 0.2);
  ASSERT_FALSE(scan.fine.points.empty());
  for (std::size_t i = 0; i < scan.fine.points.size(); ++i)
    EXPECT_GE(scan.fine.normals[i].dot(scan.station - scan.fine.points[i]), 0);
}

TEST(Surface, WithoutAStationASphereIsSeenFromOutside) {
  const Eigen::Vector3d centre(3, -2, 7);
  const SampledScan scan = sampled(sphere_points(60000, centre, 1.0, 3), 0.06, station_option("unknown"));
  ASSERT_EQ(scan.station_kind, StationKind::unknown);
  ASSERT_GT(scan.points.size(), 2000u);
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    EXPECT_GT(scan.normals[i].dot((scan.points[i] - centre.cast<float>()).normalized()), 0.8f);
  for (std::size_t i = 0; i < scan.fine.points.size(); ++i)
    EXPECT_GT(scan.fine.normals[i].dot((scan.fine.points[i] - centre.cast<float>()).normalized()), 0.5f);
}

// A depth image of a ball with a plate far behind it: seen from its middle, the plate faces inwards.
TEST(Surface, TheNormalsOfADepthImageFaceTheViewer) {
  Points points;
  for (const Eigen::Vector3f& p : testing::sphere_points(20000, {0, 0, 0}, 1, 1))
    if (p.z() > 0.2f) points.push_back(p);
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) {
      const Eigen::Vector3f p(-3 + 0.1f * static_cast<float>(i), -3 + 0.1f * static_cast<float>(j), -1.5f);
      if (p.head<2>().norm() > 1.3f) points.push_back(p);
    }
  const SampledScan scan = sampled(points, 0.15, station_option("unknown"));
  std::size_t facing = 0;
  for (const auto& n : scan.normals) facing += n.z() > 0;
  EXPECT_GT(facing, scan.normals.size() * 98 / 100);
}

TEST(Surface, OrientOutwardsTurnsEachPartAsAWhole) {
  Points points = testing::sphere_points(3000, {-4, 0, 0}, 1, 1);
  const Points other = testing::sphere_points(3000, {4, 0, 0}, 1, 2);
  points.insert(points.end(), other.begin(), other.end());
  std::vector<Eigen::Vector3f> outwards, normals;
  Rng rng(3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f centre(i < 3000 ? -4.0f : 4.0f, 0, 0);
    outwards.push_back((points[i] - centre).normalized());
    normals.push_back(rng.below(2) ? outwards.back() : Eigen::Vector3f(-outwards.back()));
  }
  orient_outwards(points, 0.1f, normals);
  // Each sphere is one part with one sign; which one is decided by the side that faces away from the middle of both.
  for (const std::size_t first : {std::size_t{0}, std::size_t{3000}}) {
    std::size_t out = 0;
    for (std::size_t i = first; i < first + 3000; ++i) out += normals[i].dot(outwards[i]) > 0;
    EXPECT_TRUE(out == 0 || out == 3000) << out;
  }
}

TEST(Surface, OrientLikeTakesTheSignOfTheNearSurface) {
  const Points coarse = square_of_points(8, Eigen::Matrix3d::Identity());
  const std::vector<Eigen::Vector3f> down(coarse.size(), -Eigen::Vector3f::UnitZ());
  Points fine;
  for (int x = 0; x < 14; ++x) fine.emplace_back(0.5f * static_cast<float>(x), 3.3f, 0.01f);
  std::vector<Eigen::Vector3f> normals(fine.size(), Eigen::Vector3f::UnitZ());
  normals[3] = -normals[3];
  orient_like(coarse, down, 1.0f, fine, normals);
  for (const auto& n : normals) EXPECT_EQ(n.z(), -1.0f);
}

}  // namespace
}  // namespace isthmus
