#include "geometry/point_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/rng.h"

namespace isthmus {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Eigen::Vector3f in_cube(Rng& rng, double low, double high) {
  return Eigen::Vector3d(rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high)).cast<float>();
}

Points random_points(std::size_t n, double low, double high, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i) points.push_back(in_cube(rng, low, high));
  return points;
}

// A few tight clumps and much emptiness, half of it at negative coordinates.
Points clustered_points(std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3f centre = in_cube(rng, -40, 40);
    for (int i = 0; i < 60; ++i) points.push_back(centre + in_cube(rng, -0.2, 0.2));
  }
  return points;
}

struct Cloud {
  const char* name;
  Points points;
};

std::vector<Cloud> clouds() {
  Points duplicates = random_points(100, -3, 3, 3);
  for (int copy = 0; copy < 3; ++copy) duplicates.insert(duplicates.end(), duplicates.begin(), duplicates.begin() + 40);
  Points lattice;  // every point on the border of a cell
  for (int x = -4; x <= 4; ++x)
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z)
        lattice.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  return {{"random", random_points(600, -5, 5, 1)},
          {"clustered", clustered_points(2)},
          {"negative", random_points(400, -900, -890, 4)},
          {"duplicates", duplicates},
          {"lattice", lattice}};
}

std::vector<std::uint32_t> brute_within(const Points& points, const Eigen::Vector3f& query, float radius_m) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if ((points[i] - query).squaredNorm() <= radius_m * radius_m) found.push_back(i);
  return found;
}

TEST(PointGrid, FindsTheSameNeighboursAsBruteForceForAnyCellSize) {
  for (const Cloud& cloud : clouds())
    for (const float cell : {0.3f, 1.0f, 4.0f}) {
      const PointGrid grid(cloud.points, cell);
      for (const float radius : {0.25f, 1.0f, 2.5f})
        for (std::size_t q = 0; q < cloud.points.size(); q += 17) {
          const Eigen::Vector3f query =
              cloud.points[q] + (q % 2 ? Eigen::Vector3f(0.1f, -0.2f, 0.05f) : Eigen::Vector3f::Zero());
          std::vector<std::uint32_t> found;
          grid.for_each_within(query, radius, [&](std::uint32_t i, float sq) {
            EXPECT_FLOAT_EQ(sq, (cloud.points[i] - query).squaredNorm());
            found.push_back(i);
          });
          std::sort(found.begin(), found.end());
          ASSERT_EQ(found, brute_within(cloud.points, query, radius))
              << cloud.name << ", cell " << cell << ", radius " << radius;
        }
    }
}

TEST(PointGrid, VisitsInTheSameOrderEveryTime) {
  const Points points = clustered_points(9);
  const PointGrid one(points, 0.5f), two(points, 0.5f);
  const auto order = [&](const PointGrid& grid) {
    std::vector<std::uint32_t> visited;
    for (const auto& p : points) grid.for_each_within(p, 0.7f, [&](std::uint32_t i, float) { visited.push_back(i); });
    return visited;
  };
  EXPECT_EQ(order(one), order(two));
}

TEST(PointGrid, NearestIsTheNearestAndTiesGoToTheSmallerIndex) {
  for (const Cloud& cloud : clouds()) {
    const PointGrid grid(cloud.points, 0.8f);
    Rng rng(11);
    for (int q = 0; q < 60; ++q) {
      const Eigen::Vector3f query = cloud.points[rng.below(cloud.points.size())] + in_cube(rng, -1, 1);
      std::int64_t best = -1;
      float best_sq = 1.5f * 1.5f;
      for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
        const float sq = (cloud.points[i] - query).squaredNorm();
        if (sq < best_sq || (best < 0 && sq <= best_sq)) best = i, best_sq = sq;
      }
      const auto [index, sq] = grid.nearest_within(query, 1.5f);
      ASSERT_EQ(index, best) << cloud.name;
      if (best >= 0) {
        EXPECT_FLOAT_EQ(sq, best_sq);
      }
    }
  }
  const Points twins{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  EXPECT_EQ(PointGrid(twins, 0.5f).nearest_within({0, 0, 0}, 2).first, 0);
  EXPECT_EQ(PointGrid(twins, 0.5f).nearest_within({1, 0, 0}, 2).first, 0);
}

TEST(PointGrid, NothingWithinReachIsAnAnswerNotAnError) {
  const Points none, one{{5, 5, 5}};
  EXPECT_EQ(PointGrid(none, 1.0f).nearest_within({0, 0, 0}, 3).first, -1);
  const auto [index, sq] = PointGrid(one, 1.0f).nearest_within({0, 0, 0}, 3);
  EXPECT_EQ(index, -1);
  EXPECT_EQ(sq, std::numeric_limits<float>::infinity());
  int visited = 0;
  PointGrid(none, 1.0f).for_each_within({0, 0, 0}, 10, [&](std::uint32_t, float) { ++visited; });
  EXPECT_EQ(visited, 0);
}

TEST(PointGrid, APointAtExactlyTheRadiusCounts) {
  const Points points{{0, 0, 0}, {2, 0, 0}};
  int visited = 0;
  PointGrid(points, 0.5f).for_each_within({0, 0, 0}, 2.0f, [&](std::uint32_t, float) { ++visited; });
  EXPECT_EQ(visited, 2);
}

}  // namespace
}  // namespace isthmus
