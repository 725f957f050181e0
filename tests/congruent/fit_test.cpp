#include "congruent/fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "congruent/refine.h"
#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points moved(const Points& points, const Transform& t) {
  Points out;
  for (const auto& p : points) out.push_back(t * p);
  return out;
}

TEST(FitRigid, RecoversAnyPoseFromFourCoplanarPoints) {
  const Points corners{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1.5, 0}};
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const Transform truth = test::random_transform(rng, 10);
    const auto fit = fit_rigid(corners, moved(corners, truth));
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->target_from_source.isApprox(truth, 1e-9));
    EXPECT_NEAR(fit->rms_m, 0, 1e-9);
  }
}

TEST(FitRigid, NeverReflects) {
  const Points corners{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Points mirrored = corners;
  for (auto& p : mirrored) p.x() = -p.x();
  const auto fit = fit_rigid(corners, mirrored);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->target_from_source.linear().determinant(), 1, 1e-9);
  EXPECT_GT(fit->rms_m, 0.1);
}

TEST(FitRigid, ReportsTheResidual) {
  // A square whose corners are lifted in turn by +-0.1: no motion helps, the residual is 0.1.
  const Points corners{{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  Points lifted = corners;
  for (std::size_t k = 0; k < 4; ++k) lifted[k].z() = k % 2 == 0 ? 0.1 : -0.1;
  const auto fit = fit_rigid(corners, lifted);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->rms_m, 0.1, 1e-9);
}

TEST(FitRigid, RefusesWhatFixesNoRotation) {
  EXPECT_FALSE(fit_rigid({}, {}));
  const Points two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(fit_rigid(two, two));
  const Points line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  EXPECT_FALSE(fit_rigid(line, line));
  const Points equal(4, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(fit_rigid(equal, equal));
  Points broken{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_FALSE(fit_rigid(broken, broken));
}

TEST(DiagonalFit, IsExactOnExactCornersAndCloseOnNoisyOnes) {
  const std::array<Eigen::Vector3d, 4> corners{Eigen::Vector3d(-1, 0, 0), {2, 0.3, 0}, {0, -1, 0}, {0.4, 1.5, 0}};
  Rng rng(1);
  for (int i = 0; i < 50; ++i) {
    const Transform truth = test::random_transform(rng, 10);
    std::array<Eigen::Vector3d, 4> there = corners;
    for (auto& p : there) p = truth * p;
    EXPECT_TRUE(DiagonalFit(corners)(there).isApprox(truth, 1e-9));
    for (auto& p : there) p += Eigen::Vector3d(rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0);
    const auto best = fit_rigid(corners, there);
    ASSERT_TRUE(best);
    for (const auto& p : corners)
      EXPECT_LT(displacement_m(DiagonalFit(corners)(there), best->target_from_source, p), 0.1);
  }
}

TEST(Refined, PullsANearPoseOntoTheSurface) {
  const auto target = recentred(test::sample_yard(0.15, 0.003, 0.05, 1).view(), true);
  const auto source = recentred(test::sample_yard(0.15, 0.003, 0.05, 2).view(), true);
  Rng rng(1);
  const ScoreSample sample = draw_sample(source, 600, rng);
  const FacingGrid grid(target, 0.25, 0.8);
  Transform truth = Transform::Identity();
  truth.translation() = source.centre - target.centre;
  Transform start = truth;
  start.translate(Eigen::Vector3d(0.06, -0.05, 0.04)).rotate(rotation_from_vector({0.02, -0.01, 0.03}));
  const Transform end = refined(grid, target, sample, start, 8);
  EXPECT_LT(displacement_m(end, truth, Eigen::Vector3d(2, 1, 0)), 0.02);
  EXPECT_NEAR(end.linear().determinant(), 1, 1e-9);
}

TEST(Refined, HoldsWhatOnePlaneLeavesOpen) {
  LocalCloud plane;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      plane.points.emplace_back(0.1F * static_cast<float>(i - 10), 0.1F * static_cast<float>(j - 10), 0.0F);
      plane.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
  plane.diameter_m = 2;
  Rng rng(1);
  const ScoreSample sample = draw_sample(plane, 200, rng);
  Transform start = Transform::Identity();
  start.translation() = Eigen::Vector3d(0.3, 0.2, 0.05);
  const Transform end = refined(FacingGrid(plane, 0.2, 0.8), plane, sample, start, 5);
  EXPECT_NEAR(end.translation().x(), 0.3, 1e-6);
  EXPECT_NEAR(end.translation().y(), 0.2, 1e-6);
  EXPECT_NEAR(end.translation().z(), 0, 1e-3);
  EXPECT_LT(rotation_angle_rad(end.linear()), 1e-3);
}

TEST(Refined, ReturnsTheInputWhereNothingCorresponds) {
  const auto cloud = recentred(test::random_cube(50, 1, 1).view(), true);
  Rng rng(1);
  Transform far = Transform::Identity();
  far.translation().x() = 100;
  EXPECT_TRUE(refined(FacingGrid(cloud, 0.1, 0.8), cloud, draw_sample(cloud, 50, rng), far, 5).isApprox(far, 0));
}

}  // namespace
}  // namespace isthmus::congruent
