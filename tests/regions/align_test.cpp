#include "regions/align.h"

#include <gtest/gtest.h>

#include <cmath>

#include "regions/hall_pair.h"

namespace isthmus {
namespace {

using testing::all_points;
using testing::HallPair;
using testing::pose_of;

// One match with everything frozen but the pose: its residual is linear in a small motion.
struct FrozenMatch {
  Eigen::Vector3d p_in_target, q, n;
  double weight;
};

std::vector<FrozenMatch> frozen_matches(const ScanModel& source, const ScanModel& target, const Transform& t,
                                        float gate_m, MatchWeights weights) {
  std::vector<FrozenMatch> out;
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    const Eigen::Vector3d p = t * source.points[i].cast<double>();
    const std::int32_t j = target.fine.near(p.cast<float>());
    if (j < 0 || target.variation[static_cast<std::size_t>(j)] >= 1) continue;
    const Eigen::Vector3d n = target.normals[static_cast<std::size_t>(j)].cast<double>();
    if (n.dot(t.linear() * source.normals[i].cast<double>()) < 0.5) continue;
    const Eigen::Vector3d q = target.points[static_cast<std::size_t>(j)].cast<double>();
    const double ratio = n.dot(p - q) / static_cast<double>(gate_m);
    if (ratio * ratio >= 1) continue;
    const double roughness =
        static_cast<double>(source.variation[i]) + static_cast<double>(target.variation[static_cast<std::size_t>(j)]);
    const double certainty = weights == MatchWeights::alike ? 1 : 1 / (1 + std::pow(1.2 / 0.07, 2) * roughness);
    out.push_back({p, q, n, certainty * std::pow(1 - ratio * ratio, 2)});
  }
  return out;
}

double cost(const std::vector<FrozenMatch>& matches, const Eigen::Vector3d& centre, const Vector6d& x) {
  const Eigen::Matrix3d turn = rotation_from_vector(x.tail<3>());
  double sum = 0;
  for (const FrozenMatch& m : matches) {
    const double r = m.n.dot(centre + turn * (m.p_in_target - centre) + x.head<3>() - m.q);
    sum += m.weight * r * r;
  }
  return sum;
}

class PointToPlaneBy : public ::testing::TestWithParam<MatchWeights> {};

TEST_P(PointToPlaneBy, NormalEquationsAreTheDerivativesOfTheCost) {
  const HallPair pair;
  const Transform t = pose_of({0.03, -0.02, 0.04}, {0.004, -0.003, 0.006}) * pair.data.target_from_source;
  const Eigen::Vector3d centre = t * pair.source.centroid.cast<double>();
  const float gate = 0.3f;
  NormalEquations e;
  add_point_to_plane(pair.source, pair.target, t, all_points(pair.source), false, gate, centre, e, GetParam());
  const auto matches = frozen_matches(pair.source, pair.target, t, gate, GetParam());
  ASSERT_GT(e.matches, 300u);
  EXPECT_NEAR(static_cast<double>(e.matches), static_cast<double>(matches.size()), 5);
  EXPECT_NEAR(e.sq_residual_sum, cost(matches, centre, Vector6d::Zero()), 0.01 * e.sq_residual_sum);
  constexpr double kStep = 1e-4;
  const auto at = [&](int i, double si, int j, double sj) {
    Vector6d x = Vector6d::Zero();
    x[i] += si, x[j] += sj;
    return cost(matches, centre, x);
  };
  const double scale_a = e.a.norm(), scale_b = e.b.norm();
  for (int i = 0; i < 6; ++i) {
    const double gradient = (at(i, kStep, i, 0) - at(i, -kStep, i, 0)) / (2 * kStep);
    EXPECT_NEAR(e.b[i], -0.5 * gradient, 0.01 * scale_b) << i;
    for (int j = 0; j < 6; ++j) {
      // Gauss-Newton: second derivatives of the residuals themselves (rotations only) are left out.
      const double second =
          (at(i, kStep, j, kStep) - at(i, kStep, j, -kStep) - at(i, -kStep, j, kStep) + at(i, -kStep, j, -kStep)) /
          (4 * kStep * kStep);
      EXPECT_NEAR(e.a(i, j), 0.5 * second, 0.02 * scale_a) << i << ", " << j;
    }
  }
  EXPECT_LT((e.a - e.a.transpose()).norm(), 1e-5 * scale_a);
}

INSTANTIATE_TEST_SUITE_P(Weights, PointToPlaneBy, ::testing::Values(MatchWeights::alike, MatchWeights::by_roughness));

/// Equations of planes across the three axes with these stiffnesses.
NormalEquations planes_across(const Eigen::Vector3d& stiffness) {
  NormalEquations e;
  e.a.topLeftCorner<3, 3>() = stiffness.asDiagonal();
  e.weight = stiffness.sum();
  return e;
}

TEST(PointToPlane, FlatSurfacesHoldWhereTheyAreManyAndFaceAllWays) {
  const NormalEquations alike = planes_across({100, 200, 700});
  EXPECT_TRUE(flat_surfaces_hold(planes_across({30, 60, 210}), alike));
  EXPECT_FALSE(flat_surfaces_hold(planes_across({10, 20, 70}), alike)) << "a tenth of the weight";
  EXPECT_FALSE(flat_surfaces_hold(planes_across({20, 180, 600}), alike)) << "what is rough held one direction";
  EXPECT_TRUE(flat_surfaces_hold(planes_across({0, 0, 0}), planes_across({0, 0, 0})));
}

TEST(PointToPlane, StepsConvergeToTheTruth) {
  const HallPair pair;
  const Transform truth = pair.data.target_from_source;
  Transform t = pose_of({0.1, -0.08, 0.06}, {0.006, 0.008, -0.012}) * truth;
  const auto all = all_points(pair.source);
  for (int step = 0; step < 12; ++step) {
    const Eigen::Vector3d centre = t * pair.source.centroid.cast<double>();
    NormalEquations e;
    add_point_to_plane(pair.source, pair.target, t, all, false, pair.source.voxel_m, centre, e);
    t = solved_step(e, centre, static_cast<double>(pair.source.voxel_m)) * t;
  }
  EXPECT_LT(testing::largest_displacement_m(pair.data.source, t, truth), 0.25 * testing::kHallVoxel);
}

TEST(SolvedStep, ByHandForOneDirection) {
  NormalEquations e;
  Vector6d j;
  j << 0, 0, 1, 0, 0, 0;
  e.a = 50 * j * j.transpose();
  e.b = 50 * 0.2 * j;  // everything lies 0.2 m too low
  const Transform step = solved_step(e, {3, 1, 2}, 0.1);
  EXPECT_NEAR(step.translation().z(), 0.2, 1e-3);
  EXPECT_NEAR(step.translation().head<2>().norm(), 0, 1e-9) << "nobody sees sideways: nothing slides";
  EXPECT_NEAR((step.linear() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-9);
}

TEST(SolvedStep, TurnsAboutTheCentre) {
  NormalEquations e;
  e.a = Matrix6d::Identity() * 1e6;
  e.b << 0, 0, 0, 0, 0, 1e6 * 0.1;
  const Eigen::Vector3d centre(10, -4, 2);
  const Transform step = solved_step(e, centre, 0.1);
  EXPECT_NEAR((step * centre - centre).norm(), 0, 1e-9);
  EXPECT_NEAR(rotation_angle_rad(step.linear()), 0.1, 1e-3);
  EXPECT_GT(step.linear()(1, 0), 0);
}

TEST(SolvedStep, WithoutMatchesNothingMoves) {
  const Transform step = solved_step({}, {1, 2, 3}, 0.1);
  EXPECT_NEAR((step.matrix() - Eigen::Matrix4d::Identity()).norm(), 0, 1e-12);
}

TEST(PointToPlane, OnePlaneDoesNotSlide) {
  testing::Scene wall;
  wall.add_rectangle({5, -4, -2}, {0, 8, 0}, {0, 0, 4});
  const ScanProduct product =
      testing::product_of(testing::scan_scene(wall, pose_of({0, 0, 0}), {100000, 1e6, 0, 1}), 0.2);
  const ScanModel model(product.sampled, product.features, product.regions, ModelLevel::coarse);
  Transform t = pose_of({0.1, 0.12, -0.07});
  for (int step = 0; step < 10; ++step) {
    const Eigen::Vector3d centre = t * model.centroid.cast<double>();
    NormalEquations e;
    add_point_to_plane(model, model, t, all_points(model), false, 0.2f, centre, e);
    t = solved_step(e, centre, 0.2) * t;
  }
  EXPECT_NEAR(t.translation().x(), 0, 0.01);
  EXPECT_NEAR(t.translation().y(), 0.12, 0.02);
  EXPECT_NEAR(t.translation().z(), -0.07, 0.02);
}

}  // namespace
}  // namespace isthmus
