// Scans made worse: by how much is what was asked for.
#include "bench/degrade.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace isthmus::bench {
namespace {

using evaluate::Points;

Points grid(int n) {
  Points points;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y) points.emplace_back(0.1 * x, 0.1 * y, 0.02 * (x % 7));
  return points;
}

TEST(Degrade, NothingAskedForChangesNothing) {
  const Points points = grid(20);
  EXPECT_TRUE(Degradation{}.none());
  EXPECT_EQ(degraded(points, {}, true, 0.1, Rng(1)), points);
  EXPECT_EQ(suffix_of({}), "");
}

TEST(Degrade, NoiseHasTheStandardDeviationInVoxelsOnEachCoordinate) {
  const Points points = grid(100);
  const Points noisy = degraded(points, {.noise_voxels = 2}, false, 0.15, Rng(1));
  ASSERT_EQ(noisy.size(), points.size());
  for (int a = 0; a < 3; ++a) {
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = noisy[i][a] - points[i][a];
      sum += d, squares += d * d;
    }
    const auto n = static_cast<double>(points.size());
    EXPECT_NEAR(sum / n, 0, 0.01) << a;
    EXPECT_NEAR(std::sqrt(squares / n), 0.3, 0.01) << a;
  }
}

TEST(Degrade, OutliersAreTheShareOfTheWholeAndFillTheBox) {
  const Points points = grid(60);
  Eigen::AlignedBox3d box;
  for (const auto& p : points) box.extend(p);
  for (const double share : {0.1, 0.3, 0.5}) {
    const Points worse = degraded(points, {.outliers = share}, false, 0.1, Rng(2));
    Points sorted = points;
    const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    };
    std::sort(sorted.begin(), sorted.end(), less);
    Points added;
    std::size_t added_in_first_half = 0;
    for (std::size_t i = 0; i < worse.size(); ++i) {
      if (std::binary_search(sorted.begin(), sorted.end(), worse[i], less)) continue;
      added.push_back(worse[i]);
      added_in_first_half += i < worse.size() / 2;
    }
    EXPECT_EQ(worse.size(), points.size() + added.size()) << "every measured point is still there";
    EXPECT_NEAR(static_cast<double>(added.size()) / static_cast<double>(worse.size()), share, 0.001);
    EXPECT_NEAR(static_cast<double>(added_in_first_half) / static_cast<double>(added.size()), 0.5, 0.1);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : added) {
      EXPECT_TRUE(box.contains(p));
      mean += p / static_cast<double>(added.size());
    }
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(mean[a], box.center()[a], 0.06 * box.sizes()[a]);
  }
}

TEST(Degrade, OnlyThinnedScansLosePoints) {
  const Points points = grid(100);
  EXPECT_EQ(degraded(points, {.density = 0.1}, false, 0.1, Rng(3)), points);
  const Points thin = degraded(points, {.density = 0.1}, true, 0.1, Rng(3));
  EXPECT_NEAR(static_cast<double>(thin.size()), 1000, 100);
}

TEST(Degrade, TheSameSeedGivesTheSamePointsAndAnotherOthers) {
  const Points points = grid(30);
  const Degradation all{.noise_voxels = 1, .outliers = 0.3, .density = 0.5};
  const Points once = degraded(points, all, true, 0.1, Rng(4));
  EXPECT_EQ(once, degraded(points, all, true, 0.1, Rng(4)));
  EXPECT_NE(once, degraded(points, all, true, 0.1, Rng(5)));
  EXPECT_EQ(suffix_of(all), "-noise1-outliers0.3-density0.5");
}

TEST(Degrade, AnEmptyScanStaysEmpty) {
  EXPECT_TRUE(degraded({}, {.noise_voxels = 1, .outliers = 0.5, .density = 0.5}, true, 0.1, Rng(1)).empty());
}

}  // namespace
}  // namespace isthmus::bench
