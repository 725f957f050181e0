#include "evaluate/kd_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "base/rng.h"

namespace isthmus::evaluate {
namespace {

TEST(KdTree, AgreesWithBruteForce) {
  Rng rng(5);
  for (const std::size_t n : {0UL, 1UL, 13UL, 700UL}) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < n; ++i)  // coarse coordinates: many ties
      points.emplace_back(static_cast<double>(rng.below(6)), static_cast<double>(rng.below(6)), rng.uniform(0, 3));
    const KdTree tree(points);
    std::vector<Neighbour> found;
    for (int q = 0; q < 60; ++q) {
      const Eigen::Vector3d query(static_cast<double>(rng.below(7)), rng.uniform(0, 6), rng.uniform(0, 3));
      const double reach = q % 3 == 0 ? 1e9 : 1.5;
      std::vector<std::tuple<double, std::uint32_t>> all;
      for (std::uint32_t i = 0; i < n; ++i) {
        const double sq = (points[i] - query).squaredNorm();
        if (sq < reach * reach) all.emplace_back(sq, i);
      }
      std::sort(all.begin(), all.end());
      all.resize(std::min<std::size_t>(all.size(), 5));
      tree.nearest(query, 5, reach, found);
      ASSERT_EQ(found.size(), all.size());
      for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(found[k].index, std::get<1>(all[k]));
    }
  }
}

TEST(KdTree, AllPointsEqual) {
  const std::vector<Eigen::Vector3d> points(100, Eigen::Vector3d(1, 2, 3));
  const KdTree tree(points);
  std::vector<Neighbour> found;
  tree.nearest({1, 2, 3}, 4, 1.0, found);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[3].index, 3U);
}

}  // namespace
}  // namespace isthmus::evaluate
