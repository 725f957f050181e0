#include "congruent/oriented_cloud.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "congruent/cell_table.h"
#include "congruent/cosine_interval.h"
#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

TEST(Recentred, DropsWhatIsNotUsableAndCentresTheRest) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points{{1, 0, 0}, {nan, 0, 0}, {3, 0, 0}, {9, 9, 9}};
  const std::vector<Eigen::Vector3f> normals{{0, 0, 2}, {0, 0, 1}, {0, 0.5F, 0}, {0, 0, 0}};
  const auto oriented = recentred({points, normals}, true);
  ASSERT_EQ(oriented.points.size(), 2U);
  EXPECT_EQ(oriented.num_dropped, 2U);
  EXPECT_EQ(oriented.centre, Eigen::Vector3d(2, 0, 0));
  EXPECT_EQ(oriented.points[0], Eigen::Vector3f(-1, 0, 0));
  EXPECT_EQ(oriented.normals[1], Eigen::Vector3f(0, 1, 0));
  EXPECT_EQ(recentred({points, normals}, false).points.size(), 3U);
}

TEST(Recentred, TheBoundaryFollowsThePointsKept) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {nan, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<std::uint8_t> marks{0, 1, 0, 1};
  EXPECT_EQ(recentred({points, {}, marks}, false).boundary, std::vector<std::uint32_t>{2});
  EXPECT_TRUE(recentred({points, {}}, false).boundary.empty());
}

TEST(Recentred, KeepsDetailFarFromTheOrigin) {
  // A million metres out a float still holds multiples of 1/16 m: none of it may get lost.
  const std::vector<Eigen::Vector3f> points{{1e6F, 1e6F, 0}, {1e6F + 0.0625F, 1e6F, 0}};
  const auto local = recentred({points, {}}, false);
  EXPECT_EQ(local.points[1].x() - local.points[0].x(), 0.0625F);
}

TEST(Recentred, TheDiameterIgnoresAFewStrays) {
  auto cloud = test::random_cube(500, 2, 1);
  const double clean = recentred(cloud.view(), false).diameter_m;
  for (int i = 0; i < 5; ++i) cloud.points.emplace_back(0.0F, 0.0F, i % 2 == 0 ? 30.0F : -30.0F);
  EXPECT_NEAR(recentred(cloud.view(), false).diameter_m, clean, 0.2 * clean);
  EXPECT_EQ(recentred({}, true).diameter_m, 0);
}

TEST(ThinnedByCells, KeepsOnePointOfEachCellAndSide) {
  LocalCloud cloud;
  cloud.points = {{0.1F, 0.1F, 0.1F}, {0.2F, 0.2F, 0.2F}, {0.3F, 0.1F, 0.1F}, {1.5F, 0.1F, 0.1F}};
  cloud.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  const auto thin = thinned_by_cells(cloud, 1);
  ASSERT_EQ(thin.points.size(), 3U);
  EXPECT_EQ(thin.points[0], cloud.points[0]);
  EXPECT_EQ(thin.points[1], cloud.points[2]) << "the other side of the wall stays";
  EXPECT_EQ(thin.points[2], cloud.points[3]);
  EXPECT_EQ(thinned_by_cells(cloud, 0).points.size(), 4U);
}

TEST(ThinnedByLot, KeepsTheOrderAndExactlyAsManyAsAsked) {
  const auto cloud = recentred(test::random_cube(100, 1, 1).view(), true);
  const auto thin = thinned_by_lot(cloud, 30, Rng(1));
  ASSERT_EQ(thin.points.size(), 30U);
  ASSERT_EQ(thin.normals.size(), 30U);
  std::size_t at = 0;
  for (std::size_t i = 0; i < 30; ++i, ++at) {
    while (at < 100 && cloud.points[at] != thin.points[i]) ++at;
    ASSERT_LT(at, 100U) << "not a subsequence";
    EXPECT_EQ(cloud.normals[at], thin.normals[i]);
  }
  EXPECT_EQ(thinned_by_lot(cloud, 100, Rng(1)).points.size(), 100U);
}

TEST(CellTable, EqualsAMap) {
  Rng rng(1);
  std::vector<CellKey> keys;
  std::map<CellKey, std::vector<std::uint32_t>> expected;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const auto axis = [&] { return static_cast<int>(rng.below(20)) - 10; };
    const int x = axis(), y = axis(), z = axis();
    keys.push_back(cell_key({x, y, z}));
    expected[keys.back()].push_back(i);
  }
  std::vector<std::uint32_t> order;
  const CellTable table(keys, order);
  for (const auto& [key, entries] : expected) {
    const CellRange range = table.find(key);
    EXPECT_EQ(std::vector<std::uint32_t>(order.begin() + range.begin, order.begin() + range.end), entries);
  }
  EXPECT_EQ(table.find(cell_key({500, 0, 0})).end, 0U);
  EXPECT_EQ(CellTable().find(0).end, 0U);
}

TEST(CellOf, RoundsDownOnBothSidesOfZero) {
  EXPECT_EQ(cell_of({-0.5F, 0.5F, -2.0F}, 1), Eigen::Vector3i(-1, 0, -2));
  EXPECT_EQ(cell_of({0.99F, -0.01F, 3.0F}, 10), Eigen::Vector3i(9, -1, 30));
}

TEST(CosinesNear, HoldsTheAnglesGivenAndIsOpenAtTheEnds) {
  const CosineInterval right = cosines_near(0, 0.1);
  EXPECT_TRUE(right.contains(std::cos(1.5F)));
  EXPECT_FALSE(right.contains(std::cos(1.4F)));
  EXPECT_TRUE(cosines_near(1, 0.1).contains(1.0001F)) << "rounding above 1";
  EXPECT_TRUE(cosines_near(-1, 0.1).contains(-1.0001F));
  EXPECT_FALSE(cosines_near(1, 0.1).contains(0.9F));
}

}  // namespace
}  // namespace isthmus::congruent
