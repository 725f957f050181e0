#include "geometry/surface_lookup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/rng.h"

namespace isthmus {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Eigen::Vector3f in_cube(Rng& rng, double low, double high) {
  return Eigen::Vector3d(rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high)).cast<float>();
}

Points wavy_surface(std::size_t n, const Eigen::Vector3f& offset, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = rng.uniform(-4, 4), y = rng.uniform(-4, 4);
    points.push_back(offset + Eigen::Vector3d(x, y, 0.6 * std::sin(x) * std::cos(y)).cast<float>());
  }
  return points;
}

float nearest_distance(const Points& points, const Eigen::Vector3f& p) {
  float best = std::numeric_limits<float>::infinity();
  for (const auto& q : points) best = std::min(best, (q - p).norm());
  return best;
}

// The answer is the point nearest to the centre of the query's cell. The query lies within half a diagonal of that
// centre, so the answer is at most a whole diagonal farther than the nearest point, and a point well within reach is
// never missed.
TEST(SurfaceLookup, AnswersWithinACellDiagonalOfBruteForce) {
  for (const int reach : {1, 2})
    for (const Eigen::Vector3f& offset : {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(-700, 300, -20)}) {
      const Points points = wavy_surface(1500, offset, 5);
      const float cell = 0.25f, half_diagonal = cell * std::sqrt(3.0f) / 2, slack = 1e-3f * cell;
      const float reach_m = cell * (static_cast<float>(reach) + 0.5f);
      const SurfaceLookup lookup(points, cell, reach);
      Rng rng(6);
      int hits = 0, misses = 0;
      for (int q = 0; q < 3000; ++q) {
        const Eigen::Vector3f p = q % 2 ? Eigen::Vector3f(offset + in_cube(rng, -5, 5))
                                        : Eigen::Vector3f(points[rng.below(points.size())] + in_cube(rng, -0.3, 0.3));
        const float nearest = nearest_distance(points, p);
        const std::int32_t k = lookup.near(p);
        if (k < 0) {
          ASSERT_GT(nearest, reach_m - half_diagonal - slack);
          ++misses;
          continue;
        }
        ASSERT_LT(static_cast<std::size_t>(k), points.size());
        const float distance = (points[k] - p).norm();
        EXPECT_LE(distance, nearest + 2 * half_diagonal + slack);
        EXPECT_LE(distance, reach_m + half_diagonal + slack);
        ++hits;
      }
      EXPECT_GT(hits, 500);
      EXPECT_GT(misses, 500);
    }
}

TEST(SurfaceLookup, OfEqualPointsTheFirstIsNamed) {
  const Points points{{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {0, 0, 0}};
  const SurfaceLookup lookup(points, 0.2f, 1);
  EXPECT_EQ(lookup.near({0, 0, 0}), 0);
  EXPECT_EQ(lookup.near({1, 1, 1}), 1);
}

TEST(SurfaceLookup, NothingNearIsMinusOne) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const SurfaceLookup empty, no_points(Points{}, 0.1f, 1), one(Points{{3, -2, 1}}, 0.1f, 1);
  EXPECT_EQ(empty.near({0, 0, 0}), -1);
  EXPECT_EQ(no_points.near({0, 0, 0}), -1);
  EXPECT_EQ(one.near({3, -2, 1}), 0);
  EXPECT_EQ(one.near({3.5f, -2, 1}), -1);
  EXPECT_EQ(one.near({-1000, 1000, 0}), -1);
  EXPECT_EQ(one.near({nan, -2, 1}), -1);
}

TEST(SurfaceLookup, AFarOutlierNeitherFillsTheMemoryNorHidesTheScan) {
  Points points = wavy_surface(3000, Eigen::Vector3f::Zero(), 8);
  points.emplace_back(2e5f, -2e5f, 2e5f);
  const SurfaceLookup lookup(points, 0.1f, 1);
  EXPECT_LT(lookup.bytes(), std::size_t{64} << 20);
  std::size_t found = 0;
  for (std::size_t i = 0; i < 3000; ++i) found += lookup.near(points[i]) >= 0;
  EXPECT_GT(found, 2950u);  // the outermost 0.1 % on each side may be left out
}

TEST(SurfaceLookup, IsTheSameOnEveryConstruction) {
  const Points points = wavy_surface(800, Eigen::Vector3f::Zero(), 12);
  const SurfaceLookup one(points, 0.15f, 2), two(points, 0.15f, 2);
  Rng rng(13);
  for (int q = 0; q < 2000; ++q) {
    const Eigen::Vector3f p = in_cube(rng, -4.5, 4.5);
    ASSERT_EQ(one.near(p), two.near(p));
  }
}

}  // namespace
}  // namespace isthmus
