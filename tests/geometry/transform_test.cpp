#include "geometry/transform.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <numbers>

#include "base/rng.h"

namespace isthmus {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d random_axis(Rng& rng) { return Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized(); }

TEST(Transform, AngleIsRightFromZeroToPi) {
  Rng rng(1);
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-4, 0.3, 1.5, 3.0, kPi - 1e-4, kPi - 1e-8, kPi})
    for (int k = 0; k < 20; ++k) {
      const Eigen::Matrix3d r = Eigen::AngleAxisd(angle, random_axis(rng)).toRotationMatrix();
      EXPECT_NEAR(rotation_angle_rad(r), angle, 1e-14 + 1e-13 * angle) << angle;
    }
}

TEST(Transform, AngleOfAHalfTurnAboutAnAxisByHand) {
  Eigen::Matrix3d r;
  r << -1, 0, 0, 0, -1, 0, 0, 0, 1;
  EXPECT_DOUBLE_EQ(rotation_angle_rad(r), kPi);
  EXPECT_EQ(rotation_angle_rad(Eigen::Matrix3d::Identity()), 0.0);
}

TEST(Transform, RotationVectorByHandAndAgainstQuaternions) {
  const Eigen::Matrix3d quarter = rotation_from_vector({0, 0, kPi / 2});
  EXPECT_NEAR((quarter * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 0, 1e-15);
  EXPECT_TRUE(rotation_from_vector(Eigen::Vector3d::Zero()).isIdentity(0));
  Rng rng(2);
  for (const double angle : {1e-310, 1e-200, 1e-12, 1e-3, 1.0, kPi - 1e-9, kPi, 5.0}) {
    const Eigen::Vector3d axis = random_axis(rng);
    const Eigen::Quaterniond q(std::cos(angle / 2), std::sin(angle / 2) * axis.x(), std::sin(angle / 2) * axis.y(),
                               std::sin(angle / 2) * axis.z());
    const Eigen::Matrix3d r = rotation_from_vector(angle * axis);
    EXPECT_NEAR((r - q.toRotationMatrix()).norm(), 0, 1e-14) << angle;
    EXPECT_NEAR((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);
  }
}

TEST(Transform, DisplacementIsSeenInTheTargetFrame) {
  Transform a = Transform::Identity(), b = Transform::Identity();
  b.linear() = rotation_from_vector({0, 0, kPi});
  b.translation() = Eigen::Vector3d(0, 0, 3);
  EXPECT_NEAR(displacement_m(a, b, {2, 0, 0}), 5.0, 1e-12);  // 4 m across, 3 m up
  EXPECT_EQ(displacement_m(b, b, {2, 0, 0}), 0.0);
}

TEST(Transform, OrthonormalisedIsTheNearestRotation) {
  Rng rng(3);
  for (int k = 0; k < 50; ++k) {
    Transform t = Transform::Identity();
    t.linear() = rotation_from_vector(rng.uniform(0, 3) * random_axis(rng));
    for (int i = 0; i < 9; ++i) t.linear()(i / 3, i % 3) += 1e-3 * rng.normal();
    t.translation() = Eigen::Vector3d(1, -2, 1e6);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(t.linear(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
    const Transform out = orthonormalised(t);
    EXPECT_NEAR((out.linear() - nearest).norm(), 0, 1e-9);
    EXPECT_NEAR(out.linear().determinant(), 1, 1e-12);
    EXPECT_EQ(out.translation(), t.translation());
  }
}

TEST(Transform, OrthonormalisedKeepsARotation) {
  Rng rng(4);
  Transform t = Transform::Identity();
  for (int k = 0; k < 1000; ++k) t.linear() = t.linear() * rotation_from_vector(0.1 * random_axis(rng));
  EXPECT_NEAR((orthonormalised(t).linear() - t.linear()).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace isthmus
