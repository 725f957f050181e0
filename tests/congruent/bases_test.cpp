#include "congruent/bases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

using Points = std::vector<Eigen::Vector3f>;

TEST(BaseOf, OrdersAUnitSquareSoThatItsDiagonalsCross) {
  const Points corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto base = base_of(corners, {0, 1, 2, 3});
  ASSERT_TRUE(base);
  EXPECT_EQ(base->points, (std::array<std::uint32_t, 4>{0, 2, 1, 3}));
  EXPECT_NEAR(base->r1, 0.5, 1e-12);
  EXPECT_NEAR(base->r2, 0.5, 1e-12);
  EXPECT_NEAR(base->gap_m, 0, 1e-12);
  EXPECT_NEAR(base->length1_m, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(base->cos_angle, 0, 1e-12);
}

TEST(BaseOf, FindsTheRatiosOfAHandMadeQuadrilateral) {
  // ab runs 4 m along x, cd 5 m along y, crossing at (1, 0): a quarter along ab, two fifths along cd.
  const Points corners{{0, 0, 0}, {4, 0, 0}, {1, -2, 0}, {1, 3, 0}};
  const auto base = base_of(corners, {0, 1, 2, 3});
  ASSERT_TRUE(base);
  EXPECT_NEAR(base->r1, 0.25, 1e-12);
  EXPECT_NEAR(base->r2, 0.4, 1e-12);
  EXPECT_NEAR(base->length1_m, 4, 1e-12);
  EXPECT_NEAR(base->length2_m, 5, 1e-12);
}

TEST(BaseOf, MeasuresTheGapOffAPlane) {
  const Points corners{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0.3F}, {0, 1, 0.3F}};
  const auto base = base_of(corners, {0, 1, 2, 3});
  ASSERT_TRUE(base);
  EXPECT_NEAR(base->gap_m, 0.3, 1e-7);
}

TEST(BaseOf, RatiosSurviveAffineMapsAndLengthsSurviveRigidOnes) {
  const Points corners{{0, 0, 0}, {4, 1, 0}, {1, -2, 0}, {1.5F, 3, 0}};
  const auto base = base_of(corners, {0, 1, 2, 3});
  ASSERT_TRUE(base);
  Eigen::Matrix3f shear;
  shear << 1, 0.5F, 0, 0.2F, 2, 0, 0.3F, -0.1F, 1;
  Points sheared;
  for (const auto& p : corners) sheared.push_back(shear * p + Eigen::Vector3f(1, 2, 3));
  const auto affine = base_of(sheared, base->points);
  ASSERT_TRUE(affine);
  EXPECT_NEAR(affine->r1, base->r1, 1e-6);
  EXPECT_NEAR(affine->r2, base->r2, 1e-6);
  Rng rng(5);
  const Transform motion = test::random_transform(rng, 2);
  Points turned;
  for (const auto& p : corners) turned.push_back((motion * p.cast<double>()).cast<float>());
  const auto rigid = base_of(turned, base->points);
  ASSERT_TRUE(rigid);
  EXPECT_NEAR(rigid->length1_m, base->length1_m, 1e-5);
  EXPECT_NEAR(rigid->length2_m, base->length2_m, 1e-5);
  EXPECT_NEAR(rigid->cos_angle, base->cos_angle, 1e-6);
}

TEST(BaseOf, RefusesQuadsWhoseDiagonalsDoNotCross) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(base_of(Points{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, 0}}, {0, 1, 2, 3})) << "one inside the others";
  EXPECT_FALSE(base_of(Points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {0, 1, 2, 3})) << "collinear";
  EXPECT_FALSE(base_of(Points{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {0, 1, 2, 3})) << "coincident";
  EXPECT_FALSE(base_of(Points{{0, 0, 0}, {1, 0, 0}, {1, 1, nan}, {0, 1, 0}}, {0, 1, 2, 3})) << "not finite";
}

TEST(SelectBase, KeepsItsPromises) {
  const auto cloud = recentred(test::sample_yard(0.2, 0.005, 0.05, 1).view(), true);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Rng rng(seed);
    const auto base = select_base(cloud, {.width_m = 2.5, .coplanarity_m = 0.1}, rng);
    ASSERT_TRUE(base) << seed;
    EXPECT_LE(base->gap_m, 0.1);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const float side = (cloud.points[base->points[i]] - cloud.points[base->points[j]]).norm();
        EXPECT_LE(side, 2.5F);
        EXPECT_GE(side, 0.3F);
      }
    EXPECT_GT(base->r1, 0.05);
    EXPECT_LT(base->r1, 0.95);
  }
}

TEST(SelectBase, PrefersCornersThatFaceDifferentWays) {
  const auto cloud = recentred(test::sample_yard(0.2, 0, 0, 1).view(), true);
  double spread = 0;
  constexpr int kBases = 40;
  for (int i = 0; i < kBases; ++i) {
    Rng rng(static_cast<std::uint64_t>(i));
    const auto base = select_base(cloud, {.width_m = 3, .coplanarity_m = 0.1}, rng);
    ASSERT_TRUE(base);
    Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
    for (const auto p : base->points) sum += cloud.normals[p] * cloud.normals[p].transpose();
    spread += static_cast<double>(sum.determinant());  // 0 on one plane or two; at most (4/3)^3
  }
  EXPECT_GT(spread / kBases, 0.5);
}

TEST(SelectBase, TheLotDecidesAndRepeats) {
  const auto cloud = recentred(test::sample_yard(0.2, 0, 0, 1).view(), true);
  const BaseWish wish{.width_m = 3, .coplanarity_m = 0.1};
  Rng one(7), same(7), other(8);
  const auto a = select_base(cloud, wish, one), b = select_base(cloud, wish, same), c = select_base(cloud, wish, other);
  ASSERT_TRUE(a && b && c);
  EXPECT_EQ(a->points, b->points);
  EXPECT_NE(a->points, c->points);
}

TEST(SelectBase, TakesCornersAtTheBoundaryWhereTheyMakeABase) {
  const test::Cloud yard = test::sample_yard(0.2, 0.005, 0.05, 1);
  std::vector<std::uint8_t> marks;
  for (const auto& p : yard.points) marks.push_back(p.x() > 0.5F);
  OrientedCloud view = yard.view();
  view.at_boundary = marks;
  const auto cloud = recentred(view, true);
  ASSERT_EQ(cloud.boundary.size(), static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1)));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed), same(seed);
    const auto base = select_base(cloud, {.width_m = 2, .coplanarity_m = 0.1, .at_boundary = true}, rng);
    ASSERT_TRUE(base) << seed;
    for (const std::uint32_t corner : base->points)
      EXPECT_TRUE(std::ranges::binary_search(cloud.boundary, corner)) << seed;
    EXPECT_LE(base->gap_m, 0.1);
    const auto anywhere = select_base(cloud, {.width_m = 2, .coplanarity_m = 0.1}, same);
    ASSERT_TRUE(anywhere);
    EXPECT_NE(anywhere->points, base->points);
  }
}

TEST(SelectBase, TakesCornersAnywhereWhereTheBoundaryMakesNoBase) {
  const test::Cloud yard = test::sample_yard(0.2, 0.005, 0.05, 1);
  const auto base_with = [&](std::size_t num_marked) {
    std::vector<std::uint8_t> marks(yard.points.size(), 0);
    std::fill_n(marks.begin(), num_marked, std::uint8_t{1});  // one row along a side: no area, no base
    OrientedCloud view = yard.view();
    if (num_marked > 0) view.at_boundary = marks;
    Rng rng(3);
    return select_base(recentred(view, true), {.width_m = 2.5, .coplanarity_m = 0.1, .at_boundary = true}, rng);
  };
  EXPECT_TRUE(base_with(0)) << "nothing is known of a boundary";
  EXPECT_TRUE(base_with(3)) << "three points are no base";
  EXPECT_TRUE(base_with(8)) << "a line is no base";
}

TEST(SelectBase, GivesNothingWhereThereIsNoBase) {
  const BaseWish wish{.width_m = 2, .coplanarity_m = 0.05};
  const auto none = [&](const Points& points) {
    Rng rng(1);
    return !select_base(recentred({points, {}}, false), wish, rng);
  };
  EXPECT_TRUE(none({}));
  EXPECT_TRUE(none({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_TRUE(none(Points(50, Eigen::Vector3f(1, 2, 3))));
  Points line;
  for (int i = 0; i < 50; ++i) line.emplace_back(0.1F * static_cast<float>(i), 0, 0);
  EXPECT_TRUE(none(line));
}

}  // namespace
}  // namespace isthmus::congruent
