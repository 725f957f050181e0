#include "features/axes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "base/rng.h"
#include "scan/sample_points.h"

namespace isthmus {
namespace {

using testing::empty_room;
using testing::pose_of;
using testing::sampled;
using testing::scan_scene;
using testing::Scene;

std::vector<DominantAxis> axes_of(const SampledScan& scan, std::size_t max_axes = 3) {
  return dominant_axes(scan.normals, scan.variation, max_axes);
}

double angle_between_deg(const Eigen::Vector3f& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.cast<double>().dot(b)))) * 180 / std::numbers::pi;
}

TEST(DominantAxes, ARoomHasItsThreeWhateverTheScannersTilt) {
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.02, -0.03, 1), Eigen::Vector3d(1.2, 0.7, -2)}) {
    const Transform world_from_scan = pose_of({0.5, 0.3, 0}, turn);
    const auto axes =
        axes_of(sampled(scan_scene(empty_room({7, 5, 3}), world_from_scan, {40000, 1e6, 0.003, 2}), 0.15));
    ASSERT_EQ(axes.size(), 3u);
    for (int a = 0; a < 3; ++a) {
      const Eigen::Vector3d truth = world_from_scan.linear().transpose().col(a);
      const bool found = std::any_of(axes.begin(), axes.end(), [&](const DominantAxis& axis) {
        return angle_between_deg(axis.direction, truth) < 1;
      });
      EXPECT_TRUE(found) << "axis " << a << " of the room";
    }
    for (const DominantAxis& axis : axes) {
      EXPECT_NEAR(axis.direction.norm(), 1, 1e-5);
      EXPECT_GT(axis.weight, 0.5f);
      EXPECT_GT(axis.sigma_rad, 0);
      EXPECT_LT(axis.sigma_rad, 0.05f);
      EXPECT_LT(axis.sign_agreement, 0.5f) << "opposite walls face each other";
    }
    EXPECT_TRUE(
        std::is_sorted(axes.begin(), axes.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; }));
  }
}

TEST(DominantAxes, NoMoreThanWanted) {
  const SampledScan scan = sampled(scan_scene(empty_room({7, 5, 3}), pose_of({0, 0, 0})), 0.15);
  EXPECT_EQ(axes_of(scan, 1).size(), 1u);
  EXPECT_EQ(axes_of(scan, 2).size(), 2u);
}

TEST(DominantAxes, ASphereHasNone) {
  EXPECT_TRUE(axes_of(sampled(testing::sphere_points(60000, {0.9, 0.4, 0}, 3, 1), 0.1)).empty());
}

TEST(DominantAxes, OpenGroundKnowsWhereUpIs) {
  Scene ground;
  ground.add_rectangle({-20, -20, 0}, {40, 0, 0}, {0, 40, 0});
  for (const double roll : {0.0, std::numbers::pi}) {  // upside down, up is still towards the scanner
    const Transform world_from_scan = pose_of({0, 0, 1.8}, {roll, 0, 0});
    const auto axes = axes_of(sampled(scan_scene(ground, world_from_scan, {40000, 15, 0.003, 1}), 0.2));
    ASSERT_EQ(axes.size(), 1u);
    EXPECT_GT(axes[0].sign_agreement, 0.99f);
    EXPECT_GT(axes[0].direction.cast<double>().dot(world_from_scan.linear().transpose() * Eigen::Vector3d::UnitZ()),
              0.999);
  }
}

TEST(DominantAxes, RoughSurroundingsHaveNoVote) {
  const SampledScan scan = sampled(scan_scene(empty_room({7, 5, 3}), pose_of({0, 0, 0})), 0.15);
  const std::vector<float> rough(scan.points.size(), 0.3f);
  EXPECT_TRUE(dominant_axes(scan.normals, rough, 3).empty());
  EXPECT_TRUE(dominant_axes({}, {}, 3).empty());
}

// Posts on ground too rough for a plane: only what stands across tells the vertical.
TEST(DominantAxes, PostsAloneShowTheVertical) {
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> variation;
  Rng rng(8);
  for (int k = 0; k < 3000; ++k) {
    const double a = rng.uniform(-3.14, 3.14), tilt = 0.03 * rng.normal();
    normals.push_back(Eigen::Vector3d(std::cos(a), std::sin(a), tilt).normalized().cast<float>());
    variation.push_back(0.01f);
  }
  for (int k = 0; k < 2000; ++k) {  // leaves and ground: any direction
    normals.push_back(Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>());
    variation.push_back(0.02f);
  }
  const auto axes = dominant_axes(normals, variation, 3);
  ASSERT_EQ(axes.size(), 1u);
  EXPECT_LT(angle_between_deg(axes[0].direction, Eigen::Vector3d::UnitZ()), 1);
}

}  // namespace
}  // namespace isthmus
