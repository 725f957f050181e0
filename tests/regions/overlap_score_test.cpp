#include "regions/overlap_score.h"

#include <gtest/gtest.h>

#include "regions/hall_pair.h"

namespace isthmus {
namespace {

using testing::all_points;
using testing::HallPair;
using testing::pose_of;
using testing::product_of;
using testing::scan_scene;
using testing::Scene;

constexpr double kVoxel = 0.2;

// A wall 6 m in front of the station, nothing else.
struct Wall {
  ScanProduct product;
  ScanModel model;
  Wall() : product(made()), model(product.sampled, product.features, product.regions, ModelLevel::coarse) {}
  static ScanProduct made() {
    Scene scene;
    scene.add_rectangle({6, -4, -2}, {0, 8, 0}, {0, 0, 4});
    testing::SamplingSetup setup;
    setup.options.station = "origin";  // one wall alone does not prove where the station was
    return product_of(scan_scene(scene, pose_of({0, 0, 0}), {120000, 1e6, 0, 1}), kVoxel, setup);
  }
};

PointVerdict verdict_of(const Wall& wall, const Transform& moved, std::size_t index, bool coarse = false) {
  const std::vector<std::uint32_t> one{static_cast<std::uint32_t>(index)};
  return judge_points(wall.model, wall.model, pose3f(moved), one, coarse)[0];
}

std::size_t middle_point(const ScanModel& model) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < model.points.size(); ++i)
    if ((model.points[i] - Eigen::Vector3f(6, 0, 0)).norm() < (model.points[best] - Eigen::Vector3f(6, 0, 0)).norm())
      best = i;
  return best;
}

TEST(SeenThrough, InFrontOfTheWallNotOnNotBehindNotBesideIt) {
  const Wall wall;
  const ScanModel& m = wall.model;
  EXPECT_TRUE(m.seen_through({3, 0, 0}, 0.3f));
  EXPECT_TRUE(m.seen_through({5, 1, -0.5f}, 0.3f));
  EXPECT_FALSE(m.seen_through({6, 0, 0}, 0.3f));
  EXPECT_FALSE(m.seen_through({6.5f, 0.3f, 0}, 0.3f));
  EXPECT_FALSE(m.seen_through({20, 0, 0}, 0.3f));
  EXPECT_FALSE(m.seen_through({-3, 0, 0}, 0.3f)) << "nothing came back from there: who knows";
  EXPECT_FALSE(m.seen_through({5, 0, 0}, 1.2f)) << "within the tolerance";
}

TEST(SeenThrough, WithoutAStationNothingIs) {
  Wall wall;
  wall.product.sampled.free_space = {};
  EXPECT_FALSE(wall.model.seen_through({3, 0, 0}, 0.3f));
}

TEST(PointVerdicts, ByHand) {
  const Wall wall;
  const std::size_t p = middle_point(wall.model);
  EXPECT_EQ(verdict_of(wall, Transform::Identity(), p), PointVerdict::supported);
  EXPECT_EQ(verdict_of(wall, pose_of({-2, 0, 0}), p), PointVerdict::contradicted);
  EXPECT_EQ(verdict_of(wall, pose_of({2, 0, 0}), p), PointVerdict::neutral) << "behind the wall";
  EXPECT_EQ(verdict_of(wall, pose_of({0, 30, 0}), p), PointVerdict::neutral) << "where nobody looked";
  Transform turned = pose_of({0, 0, 0}, {0, 0, 3.14159265});  // the other side of the wall, in its place
  turned.translation() = wall.model.points[p].cast<double>() - turned.linear() * wall.model.points[p].cast<double>();
  EXPECT_EQ(verdict_of(wall, turned, p), PointVerdict::against);
  Transform edgewise = pose_of({0, 0, 0}, {0, 0, 3.14159265 / 2});
  edgewise.translation() =
      wall.model.points[p].cast<double>() - edgewise.linear() * wall.model.points[p].cast<double>();
  EXPECT_EQ(verdict_of(wall, edgewise, p), PointVerdict::neutral);
}

TEST(PointVerdicts, TheCoarseLookupForgivesMore) {
  const Wall wall;
  const Pose3f behind = pose3f(pose_of({1.9 * kVoxel, 0, 0}));
  const float coarse = score_direction(wall.model, wall.model, behind, {}, 1, true).support;
  const float fine = score_direction(wall.model, wall.model, behind, {}, 1, false).support;
  EXPECT_GT(coarse, 0.9f);
  EXPECT_LT(fine, 0.5f);
}

TEST(DirectedScore, IsTheSharesOfTheVerdicts) {
  const HallPair pair;
  const Transform off = pose_of({0.5, 0.2, 0}, {0, 0, 0.1}) * pair.data.target_from_source;
  for (const bool coarse : {false, true}) {
    const auto all = all_points(pair.source);
    const PointVerdicts verdicts = judge_points(pair.source, pair.target, pose3f(off), all, coarse);
    double counts[4] = {0, 0, 0, 0};
    for (const auto v : verdicts) counts[static_cast<int>(v)] += 1.0 / static_cast<double>(all.size());
    for (const auto& sample : {std::vector<std::uint32_t>{}, all}) {
      const DirectedScore score = score_direction(pair.source, pair.target, pose3f(off), sample, 1, coarse);
      EXPECT_NEAR(score.support, counts[static_cast<int>(PointVerdict::supported)], 1e-5);
      EXPECT_NEAR(score.contradiction, counts[static_cast<int>(PointVerdict::contradicted)], 1e-5);
      EXPECT_NEAR(score.against, counts[static_cast<int>(PointVerdict::against)], 1e-5);
    }
    const DirectedScore thinned = score_direction(pair.source, pair.target, pose3f(off), {}, 3, coarse);
    EXPECT_NEAR(thinned.support, counts[static_cast<int>(PointVerdict::supported)], 0.05);
  }
}

TEST(DirectedScore, OfNothingIsNothing) {
  SampledScan nothing;
  nothing.voxel_m = kVoxel;
  const FeatureCloud no_features;
  const RegionMap no_regions;
  const ScanModel empty(nothing, no_features, no_regions, ModelLevel::coarse);
  const Wall wall;
  EXPECT_EQ(score_direction(empty, wall.model, {}, {}, 1, false).support, 0);
  EXPECT_EQ(score_direction(wall.model, empty, {}, {}, 1, false).support, 0);
  EXPECT_EQ(score_direction(wall.model, empty, {}, {}, 1, false).contradiction, 0);
}

TEST(DirectedScore, TheTruthIsSupportedAndHardlyContradicted) {
  const HallPair pair;
  const Pose3f truth = pose3f(pair.data.target_from_source);
  const DirectedScore there = score_direction(pair.source, pair.target, truth, {}, 1, false);
  const DirectedScore back = score_direction(pair.target, pair.source, truth.inverse(), {}, 1, false);
  EXPECT_GT(there.support, 0.1f);
  EXPECT_LT(there.support, 0.9f) << "a partial overlap";
  EXPECT_LT(there.contradiction, 0.03f);
  EXPECT_LT(back.contradiction, 0.03f);
  const Pose3f wrong = pose3f(pose_of({3, 2, 0}, {0, 0, 1.2}) * pair.data.target_from_source);
  EXPECT_GT(score_direction(pair.source, pair.target, wrong, {}, 1, false).contradiction, 3 * there.contradiction);
}

TEST(Pose3f, InverseUndoesIt) {
  const Pose3f pose = pose3f(pose_of({1, 2, 3}, {0.3, -1, 2}));
  const Eigen::Vector3f p(4, -5, 6);
  EXPECT_LT((pose.inverse() * (pose * p) - p).norm(), 1e-5f);
}

}  // namespace
}  // namespace isthmus
