#include "congruent/score.h"

#include <gtest/gtest.h>

#include <set>

#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

constexpr double kFacing = 0.7;

// The stupid twin: every sample point against every target point, with the same float arithmetic.
std::int64_t brute_force(const LocalCloud& target, const ScoreSample& sample, const Transform& t, double tolerance_m) {
  const Eigen::Matrix3f rotation = t.linear().cast<float>();
  const Eigen::Vector3f translation = t.translation().cast<float>();
  const auto tolerance = static_cast<float>(tolerance_m);
  std::int64_t common = 0;
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    const Eigen::Vector3f p = rotation * sample.points[i] + translation;
    bool found = false;
    for (std::size_t j = 0; j < target.points.size() && !found; ++j)
      found = (target.points[j] - p).squaredNorm() <= tolerance * tolerance &&
              (sample.normals.empty() ||
               target.normals[j].dot((rotation * sample.normals[i]).eval()) >= static_cast<float>(std::cos(kFacing)));
    common += found ? 1 : 0;
  }
  return common;
}

TEST(Score, CountsByHand) {
  LocalCloud target;
  target.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  target.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  ScoreSample sample;
  sample.points = {{0, 0, 0.05F}, {1, 0, 0.2F}, {2, 0, 0}};  // near, too far, facing away
  sample.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, -1}};
  ScoreCounts counts;
  EXPECT_EQ(count_common(FacingGrid(target, 0.1, kFacing), sample, Transform::Identity(), -1, counts), 1);
  Transform lowered = Transform::Identity();
  lowered.translation().z() = -0.125;
  EXPECT_EQ(count_common(FacingGrid(target, 0.1, kFacing), sample, lowered, -1, counts), 2);
  EXPECT_EQ(counts.points_looked_up, 6U);
}

TEST(Score, EqualsBruteForceAtAnyPose) {
  std::int64_t seen = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const bool oriented = seed % 2 == 0;
    const auto target = recentred(test::sample_yard(0.25, 0.01, 0.1, seed).view(), oriented);
    const auto source = recentred(test::sample_yard(0.25, 0.01, 0.1, seed + 50).view(), oriented);
    const ScoreSample sample = draw_sample(source, 300, rng);
    const double tolerance_m = rng.uniform(0.05, 0.6);
    const FacingGrid grid(target, tolerance_m, kFacing);
    const Transform pose = seed < 4 ? Transform::Identity() : test::random_transform(rng, 1);
    ScoreCounts counts;
    const auto common = count_common(grid, sample, pose, -1, counts);
    ASSERT_TRUE(common);
    EXPECT_EQ(*common, brute_force(target, sample, pose, tolerance_m)) << seed;
    seen += *common;
  }
  EXPECT_GT(seen, 1000);
}

TEST(Score, GivesUpExactlyWhenTheBoundCannotBeBeaten) {
  Rng rng(1);
  const auto target = recentred(test::sample_yard(0.25, 0.01, 0.1, 1).view(), true);
  const auto source = recentred(test::sample_yard(0.25, 0.01, 0.1, 2).view(), true);
  const ScoreSample sample = draw_sample(source, 200, rng);
  const FacingGrid grid(target, 0.2, kFacing);
  const Transform pose = test::random_transform(rng, 0.5);
  ScoreCounts all, few;
  const auto exact = count_common(grid, sample, pose, -1, all);
  ASSERT_TRUE(exact);
  ASSERT_GT(*exact, 5);
  EXPECT_EQ(count_common(grid, sample, pose, *exact - 1, few), exact);
  EXPECT_FALSE(count_common(grid, sample, pose, *exact, few));
  ScoreCounts hopeless;
  EXPECT_FALSE(count_common(grid, sample, pose, 190, hopeless));
  EXPECT_LT(hopeless.points_looked_up, all.points_looked_up / 2) << "no early exit";
}

TEST(Score, AFirstLookCountsTheLeadingPoints) {
  Rng rng(1);
  const auto target = recentred(test::sample_yard(0.25, 0.01, 0.1, 1).view(), true);
  const auto source = recentred(test::sample_yard(0.25, 0.01, 0.1, 2).view(), true);
  const ScoreSample sample = draw_sample(source, 200, rng);
  ScoreSample leading = sample;
  leading.points.resize(40), leading.normals.resize(40);
  const FacingGrid grid(target, 0.2, kFacing);
  const Transform pose = Transform::Identity();
  ScoreCounts counts;
  EXPECT_EQ(count_leading(grid, sample, 40, pose, -1, counts), count_common(grid, leading, pose, -1, counts));
  EXPECT_EQ(count_leading(grid, sample, 1000, pose, -1, counts), count_common(grid, sample, pose, -1, counts));
}

TEST(Score, NearestFacingEqualsBruteForce) {
  const auto target = recentred(test::sample_yard(0.2, 0.01, 0.1, 1).view(), true);
  const auto probe = recentred(test::sample_yard(0.5, 0.05, 0.5, 2).view(), true);
  const FacingGrid grid(target, 0.3, kFacing);
  for (std::size_t i = 0; i < probe.points.size(); ++i) {
    std::optional<std::uint32_t> nearest;
    float best = 0.3F * 0.3F;
    for (std::uint32_t j = 0; j < target.points.size(); ++j) {
      const float d = (target.points[j] - probe.points[i]).squaredNorm();
      if (d < best && target.normals[j].dot(probe.normals[i]) >= static_cast<float>(std::cos(kFacing)))
        nearest = j, best = d;
    }
    EXPECT_EQ(grid.nearest_facing(probe.points[i], probe.normals[i]), nearest) << i;
  }
}

TEST(Score, PointsFarOutsideAndEmptyTargetsCountNothing) {
  ScoreSample sample;
  sample.points = {{0, 0, 0}, {1, 1, 1}};
  ScoreCounts counts;
  EXPECT_EQ(count_common(FacingGrid({}, 0.1, kFacing), sample, Transform::Identity(), -1, counts), 0);
  LocalCloud target;
  target.points = {{0, 0, 0}};
  Transform away = Transform::Identity();
  away.translation().x() = 1e30;
  EXPECT_EQ(count_common(FacingGrid(target, 0.1, kFacing), sample, away, -1, counts), 0);
}

TEST(ScoreSample, DrawsDifferentPointsAndRepeats) {
  const auto source = recentred(test::random_cube(50, 1, 1).view(), true);
  Rng one(3), same(3);
  const ScoreSample a = draw_sample(source, 20, one), b = draw_sample(source, 20, same);
  ASSERT_EQ(a.points.size(), 20U);
  std::set<float> xs;
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(a.points[i], b.points[i]);
    xs.insert(a.points[i].x());
  }
  EXPECT_EQ(xs.size(), 20U);
  EXPECT_EQ(draw_sample(source, 1000, one).points.size(), 50U);
  EXPECT_TRUE(draw_sample({}, 10, one).points.empty());
}

}  // namespace
}  // namespace isthmus::congruent
