// One pair from features to verdict on halls with known poses.
#include "pairwise/register_pair.h"

#include <gtest/gtest.h>

#include "pairwise/pair_options_for_tests.h"
#include "pairwise/synthetic_product.h"
#include "pairwise/threads.h"
#include "store/archive.h"

namespace isthmus {
namespace {

using testing::kHallVoxel;
using testing::partial_overlap;
using testing::PartialOverlap;
using testing::pose_of;

void expect_right(const PairResult& result, const ScanProduct& source, const Transform& truth) {
  EXPECT_EQ(result.verdict, Verdict::accepted)
      << to_string(result.verdict) << ": " << result.reason << ", probability " << result.probability;
  ASSERT_TRUE(result.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(source, *result.target_from_source, truth), 0.5 * kHallVoxel);
}

void expect_complete(const PairResult& result) {
  EXPECT_FALSE(result.reason.empty());
  EXPECT_TRUE(result.probability >= 0 && result.probability <= 1);
  EXPECT_EQ(result.overlap, std::min(result.overlap_of_source, result.overlap_of_target));
  EXPECT_GT(result.rms_m, 0);
  EXPECT_FALSE(result.evidence.empty());
  EXPECT_FALSE(result.counts.empty());
  EXPECT_FALSE(result.seconds_by_stage.empty());
  EXPECT_TRUE(result.information.allFinite());
}

double evidence_of(const PairResult& result, const std::string& name) {
  for (const auto& [term, value] : result.evidence) {
    if (term == name) return value;
  }
  ADD_FAILURE() << "no term " << name;
  return -1;
}

TEST(RegisterPair, PartialOverlapUnderAHeading) {
  const PartialOverlap pair = partial_overlap(1, {0, 0, 2.4}, 500000);
  ASSERT_FALSE(pair.source.sampled.fine.points.empty()) << "dense enough for the fine level";
  const PairResult result = register_pair(pair.source, pair.target, PairOptions{});
  expect_right(result, pair.source, pair.target_from_source);
  expect_complete(result);
  EXPECT_GT(result.overlap, 0.1);
  EXPECT_LT(result.overlap, 0.8);
}

TEST(RegisterPair, PartialOverlapUnderAnyRotation) {
  const PartialOverlap pair = partial_overlap(2, {1.8, -0.9, 1.2});
  expect_right(register_pair(pair.source, pair.target, PairOptions{}), pair.source, pair.target_from_source);
}

TEST(RegisterPair, TheOtherWayRoundIsTheInverse) {
  const PartialOverlap pair = partial_overlap(1, {0, 0, -1.1});
  const PairResult back = register_pair(pair.target, pair.source, PairOptions{});
  expect_right(back, pair.target, pair.target_from_source.inverse());
}

// Moving either cloud (station and all) moves the answer along.
TEST(RegisterPair, DoesNotDependOnTheFramesOfTheScans) {
  const testing::Scene hall = testing::furnished_hall(1);
  const Transform world_from_source = pose_of({-3, -1, 1.7}, {0, 0, 2}), world_from_target = pose_of({3, 0.7, 1.8});
  const testing::Points source = testing::scan_scene(hall, world_from_source, {60000, 11, 0.004, 11});
  const testing::Points target = testing::scan_scene(hall, world_from_target, {60000, 11, 0.004, 12});
  const Transform truth = world_from_target.inverse() * world_from_source;
  const auto product_in_frame = [](const testing::Points& points, const Transform& frame) {
    testing::SamplingSetup setup;
    setup.header.station_in_scan = frame.translation();
    return testing::product_of(testing::moved(points, frame), kHallVoxel, setup);
  };
  const Transform here = Transform::Identity(), there = pose_of({40, -25, 6}, {0.7, 1.1, -0.4});
  for (const auto& [source_frame, target_frame] : {std::pair(there, here), std::pair(here, there)}) {
    const ScanProduct a = product_in_frame(source, source_frame), b = product_in_frame(target, target_frame);
    expect_right(register_pair(a, b, PairOptions{}), a, target_frame * truth * source_frame.inverse());
  }
}

TEST(RegisterPair, TheSameBytesForAnyNumberOfThreads) {
  const PartialOverlap pair = partial_overlap(1, {0.2, 0, 1.7});
  const auto run = [&] {
    PairResult result = register_pair(pair.source, pair.target, PairOptions{});
    result.seconds_by_stage.clear();
    return store::to_bytes(result);
  };
  const std::string one = testing::with_threads(1, run);
  EXPECT_EQ(testing::with_threads(2, run), one);
  EXPECT_EQ(testing::with_threads(7, run), one);
}

TEST(RegisterPair, TwoScansFromOnePlaceLieOnEachOther) {
  const testing::Scene hall = testing::furnished_hall(3);
  const ScanProduct one =
      testing::product_of(testing::scan_scene(hall, pose_of({0, 0, 1.7}), {60000, 1e6, 0.004, 1}), kHallVoxel);
  const PairResult result = register_pair(one, one, PairOptions{});
  expect_right(result, one, Transform::Identity());
  // The lookup finds a point near, not the nearest: on curved and cluttered places another plane.
  EXPECT_GT(evidence_of(result, "share_under_6mm"), 0.9);
}

TEST(RegisterPair, SharesUnderABoundGrowWithTheBound) {
  const PartialOverlap pair = partial_overlap(1, {0, 0, 2.4});
  const PairResult result = register_pair(pair.source, pair.target, PairOptions{});
  const double tight = evidence_of(result, "share_under_6mm"), wide = evidence_of(result, "share_under_20mm");
  EXPECT_GT(tight, 0.1);
  EXPECT_LT(tight, wide);
  EXPECT_LE(wide, 1);
}

TEST(RegisterPair, APriorIsJudgedLikeAnyHypothesis) {
  const PartialOverlap pair = partial_overlap(1, {0, 0, 0.8});
  const Transform near = pose_of({0.1, -0.1, 0.05}, {0, 0, 0.01}) * pair.target_from_source;
  const Transform wrong = pose_of({2, 1, 0}, {0, 0, 0.7}) * pair.target_from_source;
  const std::vector<Transform> priors{wrong, near};
  const PairResult result = register_pair(pair.source, pair.target, testing::no_search(), priors);
  ASSERT_TRUE(result.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(pair.source, *result.target_from_source, pair.target_from_source),
            0.5 * kHallVoxel);
  const PairResult misled = register_pair(pair.source, pair.target, testing::no_search(), std::span(&wrong, 1));
  EXPECT_NE(misled.verdict, Verdict::accepted) << "a user's word is no evidence";
}

// Two rooms of one plan and furniture, and a door between them: laid on each other they explain more than through the
// door, but for the wall that would close it.
TEST(RegisterPair, ARoomLaidOnItsEqualIsPassedOver) {
  testing::Scene rooms;
  const auto wall = [&](double x, double y_from, double y_to, double z_from, double z_to) {
    rooms.add_rectangle({x, y_from, z_from}, {0, y_to - y_from, 0}, {0, 0, z_to - z_from});
  };
  for (const double x : {0.0, 8.0}) {
    for (const double z : {0.0, 3.0}) rooms.add_rectangle({x, 0, z}, {8, 0, 0}, {0, 6, 0});
    for (const double y : {0.0, 6.0}) rooms.add_rectangle({x, y, 0}, {8, 0, 0}, {0, 0, 3});
    rooms.add_box({x + 2, 1, 0.4}, {1.6, 0.8, 0.8});
    rooms.add_box({x + 5.5, 5.2, 0.9}, {0.6, 1.2, 1.8});
    rooms.add_box({x + 1.2, 4.6, 0.5}, {0.9, 0.7, 1.0}, rotation_from_vector({0, 0, 0.4}));
  }
  wall(0, 0, 6, 0, 3), wall(16, 0, 6, 0, 3);
  wall(8, 0, 1.45, 0, 3), wall(8, 3.55, 6, 0, 3), wall(8, 1.45, 3.55, 2.3, 3);  // around the door
  testing::SamplingSetup setup;
  setup.options.station = "origin";
  const auto scanned = [&](double x, std::uint64_t seed) {
    return testing::product_of(testing::scan_scene(rooms, pose_of({x, 2.5, 1.6}), {60000, 1e6, 0.004, seed}),
                               kHallVoxel, setup);
  };
  const ScanProduct source = scanned(4, 1), target = scanned(12, 2);
  const Transform truth = pose_of({-8, 0, 0});
  const auto registered = [&](const std::vector<Transform>& priors) {
    return register_pair(source, target, testing::no_search(), priors);
  };
  const PairResult both = registered({Transform::Identity(), truth});
  ASSERT_TRUE(both.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(source, *both.target_from_source, truth), 0.5 * kHallVoxel) << both.reason;
  EXPECT_GT(evidence_of(both, "passed_over"), evidence_of(both, "score")) << "the other one explains more";
  EXPECT_NE(both.verdict, Verdict::accepted) << "free space alone decided";
  EXPECT_EQ(evidence_of(registered({Transform::Identity()}), "passed_over"), 0) << "nothing else to take";
  EXPECT_EQ(evidence_of(registered({truth, pose_of({-6, 1, 0})}), "passed_over"), 0)
      << "nothing speaks against the best";
}

TEST(RegisterPair, PeopleWhoWalkedOnDoNotContradict) {
  const testing::Scene empty = testing::furnished_hall(1);
  testing::Scene with_people = empty;
  for (const double x : {-5.0, -1.0, 4.5}) with_people.add_box({x, 0.4, 0.87}, {0.5, 0.4, 1.74});
  testing::SamplingSetup setup;
  setup.options.station = "origin";
  const auto scanned = [&](const testing::Scene& scene, double x, std::uint64_t seed) {
    return testing::product_of(testing::scan_scene(scene, pose_of({x, -0.8, 1.7}), {60000, 1e6, 0.004, seed}),
                               kHallVoxel, setup);
  };
  ScanProduct source = scanned(with_people, -2.5, 1);
  const ScanProduct target = scanned(empty, 2.5, 2);
  const auto contradiction = [&](bool knows_up) {
    DominantAxis axis;
    axis.direction = Eigen::Vector3f::UnitZ();
    axis.upright = knows_up;
    source.features.axes = {axis};
    const std::vector<Transform> truth{pose_of({-5, 0, 0})};
    const PairResult result = register_pair(source, target, testing::no_search(), truth);
    return evidence_of(result, "contradiction");
  };
  EXPECT_LT(contradiction(true), 0.5 * contradiction(false)) << "who stands tells a person";
}

TEST(RegisterPair, TheTraceTellsWhatEachStageProposed) {
  const PartialOverlap pair = partial_overlap(1, {0, 0, 2.4});
  PairTrace trace;
  const PairOptions options;
  register_pair(pair.source, pair.target, options, {}, &trace);
  EXPECT_FALSE(trace.seeds.empty());
  EXPECT_LE(trace.seeds.size(), static_cast<std::size_t>(options.max_seeds));
  EXPECT_FALSE(trace.grown.empty());
  EXPECT_LE(trace.grown.size(), static_cast<std::size_t>(options.max_hypotheses));
  EXPECT_FALSE(trace.polished.empty());
  EXPECT_FALSE(trace.fine.empty());
  EXPECT_LE(trace.fine.size(), static_cast<std::size_t>(options.fine_hypotheses));
}

}  // namespace
}  // namespace isthmus
