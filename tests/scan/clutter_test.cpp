// Even clutter in the air is told from surfaces; without it nothing is taken away.
#include "scan/clutter.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/point_grid.h"
#include "scan/free_space.h"
#include "scan/sample_points.h"

namespace isthmus {
namespace {

using testing::Points;
using testing::pose_of;
using testing::sampled;
using testing::with_clutter;

constexpr double kVoxel = 0.2;

Points hall_points(std::size_t num_rays = 60000) {
  return testing::scan_scene(testing::furnished_hall(1), pose_of({0, 0, 1.7}), {num_rays, 1e6, 0.004, 1});
}

double density_of(const Points& points, float voxel_m) {
  const std::vector<std::uint32_t> ones(points.size(), 1);
  return clutter_density({points, ones, voxel_m});
}

TEST(LeastCountBeyondChance, IsThePoissonTail) {
  EXPECT_EQ(least_count_beyond_chance(0), 1u) << "nothing is expected: one is more";
  EXPECT_EQ(least_count_beyond_chance(1), 6u) << "P(5 or more) = 0.0037, P(6 or more) = 0.0006";
  EXPECT_EQ(least_count_beyond_chance(4), 11u) << "P(10 or more) = 0.0081, P(11 or more) = 0.0028";
  EXPECT_NEAR(least_count_beyond_chance(101), least_count_beyond_chance(99), 4) << "where the normal tail takes over";
}

TEST(Clutter, TheDensityOfAnEvenSpreadIsFound) {
  for (const double density : {0.02, 0.1}) {
    Rng rng(3);
    Points points;
    for (int x = 0; x < 60; ++x)
      for (int y = 0; y < 50; ++y)
        for (int z = 0; z < 40; ++z)
          if (rng.uniform() < density)
            points.emplace_back(0.1f * (0.5f + static_cast<float>(x)), 0.1f * (0.5f + static_cast<float>(y)),
                                0.1f * (0.5f + static_cast<float>(z)));
    EXPECT_NEAR(density_of(points, 0.1f), density, 0.25 * density);
    Points turned = testing::moved(points, pose_of({3, -100, 7}, {0.7, -0.4, 1.1}));
    EXPECT_NEAR(density_of(turned, 0.1f), density, 0.3 * density) << "in a box askew to the axes";
  }
}

// One voxel in a thousand: most blocks of 6 voxels hold nothing.
TEST(Clutter, ThinSpreadsAreFoundInLargerBlocks) {
  const Points hall = testing::scan_scene(testing::furnished_hall(1), pose_of({0, 0, 1.7}), {60000, 1e6, 0.004, 1});
  const SampledScan clean = sampled(hall, 0.1);
  Eigen::AlignedBox3f box;
  for (const auto& p : clean.points) box.extend(p);
  for (const double density : {1e-3, 3e-3}) {
    Points points = clean.points;
    const double added = density * static_cast<double>(box.volume()) / 1e-3;
    points = with_clutter(points, added / (added + static_cast<double>(points.size())));
    EXPECT_NEAR(density_of(points, 0.1f) / density, 1, 0.3) << density;
  }
  EXPECT_EQ(density_of(clean.points, 0.1f), 0);
}

TEST(Clutter, SurfacesAloneHaveNone) {
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.7, -0.4, 1.1)}) {
    const SampledScan hall = sampled(hall_points(), kVoxel);
    const Points turned = testing::moved(hall.points, pose_of({0, 0, 0}, turn));
    EXPECT_EQ(clutter_density({turned, hall.counts, static_cast<float>(kVoxel)}), 0);
  }
  Points floors;  // two floors so close that every block between them holds a part of one
  for (int x = 0; x < 80; ++x)
    for (int y = 0; y < 80; ++y)
      for (int floor = 0; floor < 6; ++floor)
        floors.emplace_back(static_cast<float>(x), static_cast<float>(y), 6.0f * static_cast<float>(floor) + 1.0f);
  EXPECT_EQ(density_of(floors, 1.0f), 0);
}

// Half of the space between is a wood, half is bare: not even.
TEST(Clutter, FoliageIsNotEven) {
  Rng rng(5);
  Points points;
  for (int x = 0; x < 90; ++x)
    for (int y = 0; y < 90; ++y)
      for (int z = 0; z < 40; ++z) {
        const bool crown = (x / 15 + y / 15) % 2 == 0 && z > 12;
        if (z == 0 || z == 39 || (crown && rng.uniform() < 0.15))
          points.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
      }
  EXPECT_EQ(density_of(points, 1.0f), 0);
}

TEST(Clutter, FewOrDegeneratePointsHaveNone) {
  EXPECT_EQ(density_of({}, 0.1f), 0);
  EXPECT_EQ(density_of(Points{{1, 2, 3}}, 0.1f), 0);
  EXPECT_EQ(density_of(Points(50, {1, 2, 3}), 0.1f), 0);
  Points line, far;
  for (int i = 0; i < 500; ++i) line.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  EXPECT_EQ(density_of(line, 1.0f), 0);
  for (int i = 0; i < 500; ++i) far.emplace_back(1e5f * static_cast<float>(i % 7), 1e5f * static_cast<float>(i), 0.0f);
  EXPECT_EQ(density_of(far, 0.1f), 0) << "too large a box to count";
  EXPECT_TRUE(find_clutter({{}, {}, 0.1f}, 0.1).empty());
  const std::vector<std::uint32_t> ones(line.size(), 1);
  EXPECT_EQ(find_clutter({line, ones, 1.0f}, 0), std::vector<std::uint8_t>(line.size(), 0));
}

// Share of `of` that has a point of `in` within the distance.
double share_near(const Points& of, const Points& in, double distance_m) {
  const PointGrid grid(in, static_cast<float>(distance_m));
  double near = 0;
  for (const auto& p : of) near += grid.nearest_within(p, static_cast<float>(distance_m)).first >= 0;
  return near / static_cast<double>(of.size());
}

TEST(SamplingInClutter, LeavesTheSurfacesAndFewElse) {
  const SampledScan clean = sampled(hall_points(), kVoxel);
  for (const double share : {0.1, 0.3, 0.5}) {
    const SampledScan scan = sampled(with_clutter(hall_points(), share), kVoxel);
    EXPECT_GT(share_near(clean.points, scan.points, 1.0 * kVoxel), 1 - 0.4 * share) << share << ": surfaces stay";
    EXPECT_GT(share_near(scan.points, clean.points, 2.5 * kVoxel), 0.97) << share << ": what floats is gone";
    double agree = 0;
    const PointGrid grid(clean.points, static_cast<float>(kVoxel));
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const auto j = grid.nearest_within(scan.points[i], static_cast<float>(kVoxel)).first;
      agree += j >= 0 && scan.normals[i].dot(clean.normals[static_cast<std::size_t>(j)]) > 0.9f;
    }
    EXPECT_GT(agree / static_cast<double>(scan.points.size()), 0.75) << share;
    EXPECT_EQ(scan.station_kind, StationKind::origin);
    const bool noted = std::any_of(scan.notes.begin(), scan.notes.end(),
                                   [](const std::string& n) { return n.find("float") != std::string::npos; });
    EXPECT_TRUE(noted);
    EXPECT_GT(scan.num_dropped, clean.num_dropped);
  }
  for (const auto& note : clean.notes) EXPECT_EQ(note.find("float"), std::string::npos) << note;
}

// Clutter stands before the walls: it must not hide what the scanner looked through.
TEST(SamplingInClutter, FreeSpaceIsSeenThroughTheClutter) {
  const SampledScan clean = sampled(hall_points(), kVoxel);
  const SampledScan scan = sampled(with_clutter(hall_points(), 0.3), kVoxel);
  ASSERT_GT(scan.free_space.size, 0u);
  double seen = 0, of = 0;
  for (std::size_t i = 0; i < clean.points.size(); i += 7) {
    const Eigen::Vector3f ray = clean.points[i] - clean.station;
    const float nearest = scan.free_space.nearest_m[cube_cell(ray, scan.free_space.size)];
    const float nearest_clean = clean.free_space.nearest_m[cube_cell(ray, clean.free_space.size)];
    if (!std::isfinite(nearest_clean)) continue;
    ++of;
    seen += nearest > 0.7f * nearest_clean;
  }
  EXPECT_GT(seen / of, 0.8);
}

}  // namespace
}  // namespace isthmus
