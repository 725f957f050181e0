#include "features/upright.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/rng.h"
#include "features/axes.h"
#include "scan/free_space.h"

namespace isthmus {
namespace {

/// A box room 12 x 8 x 3 m, the station 1.7 m above the floor, blind within `blind_rad` of straight down and, where
/// the room has no roof, without returns from above. `scan_from_room` turns everything.
SampledScan room(const Eigen::Quaternionf& scan_from_room, float blind_rad, bool roof, bool whole_round = true) {
  constexpr int kRays = 60000;
  constexpr std::uint32_t kCells = 64;
  SampledScan scan;
  scan.voxel_m = 0.1;
  scan.station_kind = StationKind::origin;
  scan.free_space.size = kCells;
  scan.free_space.nearest_m.assign(6UL * kCells * kCells, std::numeric_limits<float>::infinity());
  Rng rng(3);
  for (int k = 0; k < kRays; ++k) {
    const Eigen::Vector3f d = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>();
    if (-d.z() > std::cos(blind_rad)) continue;
    if (!whole_round && d.x() < 0.3f) continue;
    const Eigen::Vector3f low(-5, -3.5f, -1.7f), high(7, 4.5f, 1.3f);
    float range = std::numeric_limits<float>::infinity();
    int wall = 0;
    for (int a = 0; a < 3; ++a) {
      const float hit = (d[a] > 0 ? high[a] : low[a]) / d[a];
      if (hit < range) range = hit, wall = a;
    }
    if (wall == 2 && d.z() > 0 && !roof) continue;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    normal[wall] = d[wall] > 0 ? -1.0f : 1.0f;
    scan.points.push_back(scan_from_room * (range * d));
    scan.normals.push_back(scan_from_room * normal);
    scan.variation.push_back(0.0f);
    float& nearest = scan.free_space.nearest_m[cube_cell(scan_from_room * d, kCells)];
    nearest = std::min(nearest, range);
  }
  return scan;
}

std::vector<DominantAxis> axes_of(const SampledScan& scan) {
  std::vector<DominantAxis> axes = dominant_axes(scan.normals, scan.variation, 3);
  put_upright_first(scan, axes);
  return axes;
}

Eigen::Quaternionf any_turn() {
  return Eigen::Quaternionf(Eigen::AngleAxisf(2.1f, Eigen::Vector3f(0.3f, -0.8f, 0.5f).normalized()));
}

TEST(Upright, BlindEndIsDownHoweverTheScanIsTurned) {
  for (const Eigen::Quaternionf& turn : {Eigen::Quaternionf::Identity(), any_turn()}) {
    const auto axes = axes_of(room(turn, 0.5f, true));
    ASSERT_EQ(axes.size(), 3U);
    EXPECT_TRUE(axes[0].upright);
    EXPECT_EQ(axes[0].sign_agreement, 1.0f);
    EXPECT_GT(axes[0].direction.dot(turn * Eigen::Vector3f::UnitZ()), 0.999f);
    EXPECT_FALSE(axes[1].upright);
    EXPECT_FALSE(axes[2].upright);
  }
}

TEST(Upright, OpenSkyLeavesTheSignToTheGround) {
  const auto axes = axes_of(room(any_turn(), 0.5f, false));
  ASSERT_FALSE(axes.empty());
  EXPECT_TRUE(axes[0].upright);
  EXPECT_GT(axes[0].direction.dot(any_turn() * Eigen::Vector3f::UnitZ()), 0.999f);
}

TEST(Upright, TheSkyIsNoTripodWhereNothingLiesAbove) {
  const auto axes = axes_of(room(any_turn(), 0.0f, false));  // sees the ground below itself, nothing above
  ASSERT_FALSE(axes.empty());
  EXPECT_TRUE(axes[0].upright);
  EXPECT_GT(axes[0].sign_agreement, 0.9f);
  EXPECT_GT(axes[0].direction.dot(any_turn() * Eigen::Vector3f::UnitZ()), 0.999f);
}

TEST(Upright, ACeilingWithoutAFloorLeavesTheSignOpen) {
  SampledScan scan = room(any_turn(), 0.5f, true);
  std::size_t floor = 0, kept = 0;  // a seventh of the floor stays in sight, the tripod's shadow where it was
  const Eigen::Vector3f up = any_turn() * Eigen::Vector3f::UnitZ();
  constexpr std::size_t kKeptOf = 7;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.normals[i].dot(up) > 0.9f && ++floor % kKeptOf != 0) continue;
    scan.points[kept] = scan.points[i], scan.normals[kept] = scan.normals[i], ++kept;
  }
  scan.points.resize(kept), scan.normals.resize(kept), scan.variation.resize(kept);
  const auto axes = axes_of(scan);
  ASSERT_FALSE(axes.empty());
  EXPECT_TRUE(axes[0].upright);
  EXPECT_EQ(axes[0].sign_agreement, 0.0f);
  EXPECT_GT(axes[0].direction.dot(up), 0.999f);
}

TEST(Upright, WithoutABlindConeTheNearestPlanesGoFirstUnmarked) {
  const auto axes = axes_of(room(any_turn(), 0.0f, true));
  ASSERT_EQ(axes.size(), 3U);
  for (const DominantAxis& axis : axes) EXPECT_FALSE(axis.upright);
  EXPECT_GT(std::abs(axes[0].direction.dot(any_turn() * Eigen::Vector3f::UnitZ())), 0.999f);
}

TEST(Upright, ASingleViewIsBlindAllAroundAndMarksNothing) {
  for (const DominantAxis& axis : axes_of(room(any_turn(), 0.5f, true, false))) EXPECT_FALSE(axis.upright);
}

TEST(Upright, WithoutAStationTheOrderStays) {
  SampledScan scan = room(any_turn(), 0.5f, true);
  scan.station_kind = StationKind::unknown;
  const auto before = dominant_axes(scan.normals, scan.variation, 3);
  auto after = before;
  put_upright_first(scan, after);
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_EQ(after[k].direction, before[k].direction);
}

}  // namespace
}  // namespace isthmus
