#include "regions/region_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/rng.h"
#include "regions/compact_clusters.h"

namespace isthmus {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Points row(std::size_t n) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  return points;
}

TEST(NearestPoints, AgreeWithALookAtAllPairs) {
  Rng rng(2);
  Points points;
  for (int i = 0; i < 300; ++i) {
    const auto coordinate = [&] { return static_cast<float>(rng.uniform(0, 5)); };
    const float x = coordinate(), y = coordinate(), z = coordinate();
    points.emplace_back(x, y, z);
  }
  points.emplace_back(400.0f, 0.0f, 0.0f);  // far from all
  constexpr std::size_t kCount = 7;
  for (const float reach : {0.1f, 1.0f, 20.0f}) {
    const NearestPoints nearest = nearest_points(points, kCount, reach);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      std::vector<std::pair<float, std::uint32_t>> all;
      for (std::uint32_t j = 0; j < points.size(); ++j)
        if (j != i) all.emplace_back((points[j] - points[i]).squaredNorm(), j);
      std::ranges::sort(all);
      for (std::size_t k = 0; k < kCount; ++k) EXPECT_EQ(nearest.index[i * kCount + k], all[k].second) << i;
    }
  }
}

TEST(NearestPoints, AreFewerWhereThereAreFewer) {
  EXPECT_EQ(nearest_points({}, 5, 1).count, 0U);
  EXPECT_EQ(nearest_points(row(1), 5, 1).count, 0U);
  const NearestPoints three = nearest_points(row(3), 5, 1);
  EXPECT_EQ(three.count, 2U);
  EXPECT_EQ(three.index, (std::vector<std::uint32_t>{1, 2, 0, 2, 1, 0}));
}

TEST(OfSimilarSize, KeepsGoodGroupsJoinsSmallOnesAndSplitsLargeOnes) {
  // In a row: 10 of group 7, 1 of group 3, 30 of group 9.
  const Points points = row(41);
  Groups groups(41, 9);
  std::fill_n(groups.begin(), 10, 7U);
  groups[10] = 3;
  const Groups out = of_similar_size(points, nearest_points(points, 2, 2), groups, 10);
  for (std::size_t i = 1; i < 10; ++i) EXPECT_EQ(out[i], out[0]);
  EXPECT_EQ(out[10], out[9]) << "one of its two near ones is in either group: the first wins";
  EXPECT_EQ(std::set(out.begin(), out.end()).size(), 4U) << "30 are three times ten";
  EXPECT_EQ(std::ranges::count(out, kNoGroup), 0);
}

TEST(OfSimilarSize, SmallGroupsInTheRestFallToTheRest) {
  const Points points = row(20);
  Groups groups(20, kNoGroup);
  groups[10] = 5;
  const Groups out = of_similar_size(points, nearest_points(points, 2, 2), groups, 20);
  EXPECT_EQ(std::set(out.begin(), out.end()).size(), 1U);
}

TEST(CompactClusters, AreNearestToTheirMeans) {
  Points points = row(4);
  for (const auto& p : row(4)) points.push_back(p + Eigen::Vector3f(100, 0, 0));
  EXPECT_EQ(compact_clusters(points, 2), (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1}));
  EXPECT_TRUE(compact_clusters({}, 3).empty());
}

}  // namespace
}  // namespace isthmus
