#include "pairwise/hypothesis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pairwise/threads.h"
#include "regions/hall_pair.h"

namespace isthmus {
namespace {

using testing::HallPair;
using testing::pose_of;

Hypothesis at(const Transform& t, double score = 0) {
  Hypothesis h;
  h.target_from_source = t;
  h.score = score;
  return h;
}

TEST(Polish, BringsANearPoseToTheTruthFromBothSides) {
  const HallPair pair;
  Hypothesis h = at(pose_of({0.06, -0.05, 0.05}, {0.004, -0.006, 0.008}) * pair.data.target_from_source);
  polish(pair.source, pair.target, 100000, 8, h);
  EXPECT_LT(testing::largest_displacement_m(pair.data.source, h.target_from_source, pair.data.target_from_source),
            0.25 * testing::kHallVoxel);
  EXPECT_GT(h.rms_m, 0);
  EXPECT_LT(h.rms_m, 0.5 * testing::kHallVoxel);
  // Seen from the other scan it is the same alignment.
  Hypothesis back = at(h.target_from_source.inverse());
  polish(pair.target, pair.source, 100000, 8, back);
  EXPECT_LT(testing::largest_displacement_m(pair.data.source, back.target_from_source.inverse(), h.target_from_source),
            0.1 * testing::kHallVoxel);
}

TEST(Polish, FarFromEverythingThePoseStays) {
  const HallPair pair;
  const Transform nowhere = pose_of({300, 0, 0});
  Hypothesis h = at(nowhere);
  polish(pair.source, pair.target, 1000, 4, h);
  EXPECT_LT(displacement_m(h.target_from_source, nowhere, {0, 0, 0}), 1e-9);
}

TEST(KeepDistinct, TheBestOfTwinsStays) {
  const HallPair pair;
  const Transform t = pair.data.target_from_source;
  std::vector<Hypothesis> all{at(t, 0.2), at(pose_of({0.1, 0, 0}) * t, 0.6), at(pose_of({3, 0, 0}) * t, 0.4),
                              at(t * pose_of({0, 0, 0}, {0, 0, 0.5}), 0.1)};
  keep_distinct(pair.source, 0.3, all);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].score, 0.6);
  EXPECT_EQ(all[1].score, 0.4);
  EXPECT_EQ(all[2].score, 0.1);
  std::vector<Hypothesis> none;
  keep_distinct(pair.source, 0.3, none);
  EXPECT_TRUE(none.empty());
}

std::vector<Hypothesis> truth_and_wrong_poses(const HallPair& pair, int wrong) {
  Rng rng(9);
  std::vector<Hypothesis> all;
  for (int k = 0; k < wrong; ++k)
    all.push_back(at(pose_of({rng.uniform(-4, 4), rng.uniform(-4, 4), 0}, {0, 0, rng.uniform(-3, 3)}) *
                     pair.data.target_from_source));
  all.push_back(at(pair.data.target_from_source));
  return all;
}

TEST(Weigh, TheTruthComesFirst) {
  for (const std::uint64_t hall : {1u, 2u}) {
    const HallPair pair({0, 0, 0.4}, hall);
    auto all = truth_and_wrong_poses(pair, 40);
    weigh(pair.source, pair.target, {2000}, all);
    EXPECT_LT(displacement_m(all[0].target_from_source, pair.data.target_from_source, {0, 0, 0}), 1e-9);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; }));
    for (const Hypothesis& h : all)
      for (const DirectedEvidence& e : {h.source, h.target}) {
        EXPECT_TRUE(e.support >= 0 && e.support <= 1);
        EXPECT_TRUE(e.rare_support >= 0 && e.rare_support <= e.support + 1e-6) << "weights are at most one";
        EXPECT_TRUE(e.contradiction >= 0 && e.contradiction <= 1);
        EXPECT_TRUE(e.against >= 0 && e.against <= 1);
      }
  }
}

// As in document retrieval: a word in every document says nothing. Every wrong pose keeps the floor.
TEST(Weigh, WhatEveryHypothesisExplainsWeighsLittle) {
  const HallPair pair;
  std::vector<Hypothesis> alone{at(pair.data.target_from_source)};
  auto crowd = truth_and_wrong_poses(pair, 30);
  weigh(pair.source, pair.target, {2000}, alone);
  weigh(pair.source, pair.target, {2000}, crowd);
  EXPECT_NEAR(alone[0].source.support, crowd[0].source.support, 1e-9) << "support itself does not depend on the others";
  EXPECT_NEAR(alone[0].source.rare_support, alone[0].source.support, 1e-9);
  EXPECT_LT(crowd[0].source.rare_support, 0.9 * alone[0].source.rare_support);
}

TEST(Weigh, PosesOfOneBasinCountAsOneHypothesis) {
  const HallPair pair;
  const Transform& truth = pair.data.target_from_source;
  EXPECT_TRUE(same_basin(pair.source, truth, pose_of({0.3, 0, 0}, {0, 0, 0.02}) * truth));
  EXPECT_FALSE(same_basin(pair.source, truth, pose_of({2, 0, 0}) * truth));
  EXPECT_FALSE(same_basin(pair.source, truth, truth * pose_of({0, 0, 0}, {0, 0, 0.3})));
  std::vector<Hypothesis> alone{at(truth)}, crowd(31, at(truth));
  weigh(pair.source, pair.target, {2000}, alone);
  weigh(pair.source, pair.target, {2000}, crowd);
  EXPECT_NEAR(crowd[0].source.rare_support, alone[0].source.rare_support, 1e-3);
}

double score_of(const HallPair& pair, const Transform& t, std::size_t points = 1000) {
  std::vector<Hypothesis> one{at(t)};
  weigh(pair.source, pair.target, {points}, one);
  return one[0].score;
}

TEST(Weigh, VerticalsThatLieApartAreADoubtNotABan) {
  HallPair pair;
  const Transform& truth = pair.data.target_from_source;
  const Transform tilted = truth * pose_of({0, 0, 0}, {0, 4 * std::numbers::pi / 180, 0}),
                  far_off = truth * pose_of({0, 0, 0}, {0, 0.2, 0}), wide = truth * pose_of({0, 0, 0}, {0, 0.7, 0});
  const auto mark = [&pair](bool source, bool target) {
    DominantAxis axis;
    axis.direction = Eigen::Vector3f::UnitZ();
    axis.upright = source, pair.data.source.features.axes = {axis};
    axis.upright = target, pair.data.target.features.axes = {axis};
  };
  mark(false, false);
  const double free_truth = score_of(pair, truth), free_tilted = score_of(pair, tilted),
               free_far = score_of(pair, far_off), free_wide = score_of(pair, wide);
  ASSERT_GT(free_tilted, 0);
  ASSERT_GT(free_far, 0);
  ASSERT_GT(free_wide, 0);
  for (const bool source : {true, false}) {
    mark(source, !source);  // one alone says nothing
    EXPECT_EQ(score_of(pair, tilted), free_tilted);
  }
  mark(true, true);
  EXPECT_EQ(score_of(pair, truth), free_truth);
  EXPECT_NEAR(score_of(pair, tilted) / free_tilted, std::exp(-2.0), 1e-6) << "3 degrees beyond 1, in units of 1.5";
  EXPECT_NEAR(score_of(pair, far_off) / free_far, 0.05, 1e-9);
  EXPECT_EQ(score_of(pair, wide), free_wide) << "one of the two is no vertical";
}

TEST(Weigh, APoseThatOnePlaneExplainsIsWorthATwentieth) {
  const auto scores_of = [](const ScanModel& source, const ScanModel& target, const Transform& t) {
    std::array<double, 2> scores{};
    for (const bool observed : {false, true}) {
      std::vector<Hypothesis> one{at(t)};
      Weighing weighing;
      weighing.observed = observed;
      weigh(source, target, weighing, one);
      scores[observed] = one[0].score;
    }
    return scores;
  };
  const ScanProduct flat = testing::bare_floor();
  const ScanModel model(flat.sampled, flat.features, flat.regions, ModelLevel::coarse);
  const auto on_floor = scores_of(model, model, pose_of({1, 2, 0}, {0, 0, 0.7}));
  ASSERT_GT(on_floor[0], 0.3);
  EXPECT_NEAR(on_floor[1] / on_floor[0], 0.05, 1e-9);

  const HallPair pair;
  const auto in_hall = scores_of(pair.source, pair.target, pair.data.target_from_source);
  ASSERT_GT(in_hall[0], 0);
  EXPECT_EQ(in_hall[1], in_hall[0]) << "floor and walls fix the place";
}

TEST(Climb, ReachesTheTruthFromAVoxelAwayAndNeverEndsLower) {
  const HallPair pair;
  const Transform& truth = pair.data.target_from_source;
  const double voxel = pair.source.scan.voxel_m;
  for (const Transform& start : {pose_of({0, 0.8 * voxel, 0}) * truth, pose_of({0, -voxel, 0.8 * voxel}) * truth,
                                 pose_of({0, 0, 0.5 * voxel}, {0.02, 0.01, 0}) * truth}) {
    Hypothesis h = at(start);
    climb(pair.source, pair.target, 1000, 1, h);
    const Eigen::Vector3d off =
        h.target_from_source * pair.source.centroid.cast<double>() - truth * pair.source.centroid.cast<double>();
    EXPECT_LT(off.tail<2>().norm(), 0.3 * voxel) << "the hall hardly fixes x";
    EXPECT_GT(score_of(pair, h.target_from_source), score_of(pair, start) + 0.1);
  }
  Rng rng(4);
  for (int k = 0; k < 10; ++k) {
    const Transform start = pose_of({rng.uniform(-3, 3), rng.uniform(-3, 3), 0}, {0, 0, rng.uniform(-3, 3)}) * truth;
    Hypothesis h = at(start);
    climb(pair.source, pair.target, 1000, 1, h);
    EXPECT_GE(score_of(pair, h.target_from_source), score_of(pair, start));
  }
}

TEST(Polish, UnlessWorseKeepsWhatItHad) {
  const HallPair pair;
  Rng rng(7);
  for (int k = 0; k < 10; ++k) {
    const Transform start = pose_of({rng.uniform(-1, 1), rng.uniform(-1, 1), 0}, {0, 0, rng.uniform(-0.2, 0.2)}) *
                            pair.data.target_from_source;
    Hypothesis h = at(start);
    polish_closely_unless_worse(pair.source, pair.target, 2000, 5, h);
    constexpr std::size_t kItsPoints = 2000;  // on the points that it looks at itself
    EXPECT_GE(score_of(pair, h.target_from_source, kItsPoints), 0.97 * score_of(pair, start, kItsPoints));
  }
}

// Points that lie off the planes, as at edges and in foliage, all to one side.
TEST(Polish, CloselyPlanesDecideNotWhatLiesOffThem) {
  HallPair pair;
  const Transform truth = pair.data.target_from_source;
  SampledScan tilted = pair.data.source.sampled;
  Rng rng(8);
  for (std::vector<Eigen::Vector3f>* points : {&tilted.points, &tilted.fine.points})
    for (Eigen::Vector3f& p : *points)
      if (rng.uniform(0, 1) < 0.3) p += 0.25f * static_cast<float>(tilted.voxel_m) * Eigen::Vector3f(0, 0, 1);
  const ScanModel source(tilted, pair.data.source.features, pair.data.source.regions, ModelLevel::coarse);
  const auto off = [&](const Hypothesis& h) {
    const Eigen::Vector3d middle = source.centroid.cast<double>();
    return (h.target_from_source * middle - truth * middle).norm();
  };
  Hypothesis polished = at(truth), closely = polished;
  polish(source, pair.target, 2000, 8, polished);
  polish_closely_unless_worse(source, pair.target, 2000, 8, closely);
  EXPECT_GT(off(polished), 0.03 * tilted.voxel_m) << "or there is nothing to be better than";
  EXPECT_LT(off(closely), 0.5 * off(polished));
}

TEST(Weigh, TheSameForAnyNumberOfThreads) {
  const HallPair pair;
  const auto scores = [&] {
    auto all = truth_and_wrong_poses(pair, 20);
    weigh(pair.source, pair.target, {1000}, all);
    std::vector<double> out;
    for (const Hypothesis& h : all) out.insert(out.end(), {h.score, h.source.rare_support, h.target.contradiction});
    return out;
  };
  EXPECT_EQ(testing::with_threads(1, scores), testing::with_threads(7, scores));
}

}  // namespace
}  // namespace isthmus
