// Pairs that must not be accepted, and inputs that are of no use.
#include <gtest/gtest.h>

#include "pairwise/synthetic_product.h"
#include "pairwise/threads.h"

namespace isthmus {
namespace {

using testing::furnished_hall;
using testing::kHallVoxel;
using testing::partial_overlap;
using testing::pose_of;
using testing::product_of;
using testing::scan_scene;

using Both = std::pair<const ScanProduct*, const ScanProduct*>;

void expect_not_accepted(const PairResult& result) {
  EXPECT_NE(result.verdict, Verdict::accepted) << result.reason << ", probability " << result.probability;
  EXPECT_NE(result.verdict, Verdict::failed) << result.reason;
  EXPECT_FALSE(result.reason.empty());
}

ScanProduct hall_scan(const testing::Scene& hall, const Transform& world_from_scan, std::uint64_t seed) {
  return product_of(scan_scene(hall, world_from_scan, {60000, 9, 0.004, seed}), kHallVoxel);
}

TEST(RegisterPairLimits, AMirroredSceneIsAnotherScene) {
  const testing::Scene hall = furnished_hall(1);
  const ScanProduct target = hall_scan(hall, pose_of({1, 0.7, 1.8}), 2);
  const ScanProduct mirrored = hall_scan(testing::mirrored(hall), pose_of({1, -1, 1.7}, {0, 0, 1}), 3);
  expect_not_accepted(register_pair(mirrored, target, PairOptions{}));
}

TEST(RegisterPairLimits, UnrelatedScenesAreNotAccepted) {
  const ScanProduct one = hall_scan(furnished_hall(1), pose_of({-3, 0, 1.7}), 1);
  for (const std::uint64_t other : {2u, 4u, 5u})
    expect_not_accepted(
        register_pair(one, hall_scan(furnished_hall(other), pose_of({2, 1, 1.7}, {0, 0, 1}), 2), PairOptions{}));
}

TEST(RegisterPairLimits, OnePlaneSlides) {
  testing::Scene wall;
  wall.add_rectangle({5, -6, -3}, {0, 12, 0}, {0, 0, 6});
  const ScanProduct one = product_of(scan_scene(wall, pose_of({0, 0, 0}), {80000, 7.5, 0.003, 1}), kHallVoxel);
  const ScanProduct two =
      product_of(scan_scene(wall, pose_of({0, 1.5, 0.4}, {0, 0, 0.2}), {80000, 7.5, 0.003, 2}), kHallVoxel);
  expect_not_accepted(register_pair(one, two, PairOptions{}));
}

// A corridor without a door: nothing fixes the way along it.
TEST(RegisterPairLimits, ABareCorridorSlides) {
  testing::Scene corridor;
  corridor.add_box({0, 0, 1.25}, {80, 2.2, 2.5});
  const ScanProduct one = product_of(scan_scene(corridor, pose_of({0, 0, 1.5}), {60000, 12, 0.003, 1}), kHallVoxel);
  const ScanProduct two =
      product_of(scan_scene(corridor, pose_of({5, 0.2, 1.6}, {0, 0, 0.3}), {60000, 12, 0.003, 2}), kHallVoxel);
  expect_not_accepted(register_pair(one, two, PairOptions{}));
}

TEST(RegisterPairLimits, DifferentVoxelsFailWithBothNamed) {
  const auto points = scan_scene(furnished_hall(1), pose_of({0, 0, 1.7}), {30000, 1e6, 0.004, 1});
  const PairResult result = register_pair(product_of(points, 0.2), product_of(points, 0.25), PairOptions{});
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_NE(result.reason.find("0.2 m"), std::string::npos) << result.reason;
  EXPECT_NE(result.reason.find("0.25 m"), std::string::npos) << result.reason;
  EXPECT_FALSE(result.target_from_source);
}

TEST(RegisterPairLimits, WithoutFeaturesThereIsNoHypothesisAndAReason) {
  const ScanProduct whole = hall_scan(furnished_hall(1), pose_of({0, 0, 1.7}), 1);
  ScanProduct bare = whole;
  bare.features = {};
  bare.features.dimension = whole.features.dimension;
  bare.regions = {};
  for (const auto& [source, target] : std::vector<Both>{{&bare, &whole}, {&whole, &bare}, {&bare, &bare}}) {
    const PairResult result = register_pair(*source, *target, PairOptions{});
    EXPECT_EQ(result.verdict, Verdict::rejected);
    EXPECT_FALSE(result.reason.empty());
    EXPECT_NE(result.reason, PairResult().reason);
    EXPECT_FALSE(result.target_from_source);
  }
}

TEST(RegisterPairLimits, EmptyScansDoNoHarmEvenWithAPrior) {
  ScanProduct nothing;
  nothing.sampled.voxel_m = kHallVoxel;
  const ScanProduct whole = hall_scan(furnished_hall(1), pose_of({0, 0, 1.7}), 1);
  const Transform prior = Transform::Identity();
  for (const auto& [source, target] : std::vector<Both>{{&nothing, &whole}, {&whole, &nothing}, {&nothing, &nothing}}) {
    expect_not_accepted(register_pair(*source, *target, PairOptions{}, std::span(&prior, 1)));
    expect_not_accepted(register_pair(*source, *target, PairOptions{}));
  }
}

// Equal columns at equal distances: every shift by a distance is a hypothesis, and there is no end of work to do.
TEST(RegisterPairLimits, APairOfTooMuchWorkIsEndedByItsBudget) {
  testing::Scene columns = testing::empty_room({44, 28, 4});
  for (int x = -5; x <= 5; ++x)
    for (int y = -3; y <= 3; ++y) columns.add_box({4.0 * x, 4.0 * y, 2}, {0.6, 0.6, 4});
  const ScanProduct one = hall_scan(columns, pose_of({-7, 1, 1.7}), 1);
  const ScanProduct two = hall_scan(columns, pose_of({5, -2, 1.7}, {0, 0, 1}), 2);

  PairTrace wide_trace, trace;
  PairOptions options;
  register_pair(one, two, options, {}, &wide_trace);
  options.max_seeds = 20;
  options.max_ranked_seeds = 10;
  options.max_hypotheses = 8;
  options.congruent_hypotheses = 2;
  options.fine_hypotheses = 4;
  const PairResult result = register_pair(one, two, options, {}, &trace);
  const std::size_t most_seeds = 20 + 10, most_grown = 2 * 8;  // of the two rounds
  EXPECT_GT(wide_trace.seeds.size(), 2 * most_seeds) << "there was no more work than the budget allows";
  EXPECT_GT(wide_trace.grown.size(), 2 * most_grown);
  EXPECT_GT(wide_trace.fine.size(), 4U);
  EXPECT_LE(trace.seeds.size(), most_seeds);
  EXPECT_LE(trace.grown.size(), most_grown);
  EXPECT_LE(trace.fine.size(), 4U);
  expect_not_accepted(result);

  // The budget counts work, not time: one thread or seven, it ends at the same place.
  const auto again = [&](int threads) {
    return testing::with_threads(threads, [&] { return register_pair(one, two, options); });
  };
  for (const PairResult& other : {again(1), again(7)}) {
    EXPECT_EQ(other.counts, result.counts);
    EXPECT_EQ(other.reason, result.reason);
    EXPECT_EQ(other.probability, result.probability);
    ASSERT_EQ(other.target_from_source.has_value(), result.target_from_source.has_value());
    if (other.target_from_source) {
      EXPECT_EQ(other.target_from_source->matrix(), result.target_from_source->matrix());
    }
  }
}

TEST(RegisterPairLimits, AResultStartsAsNotComputed) {
  const PairResult result;
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_EQ(result.reason, "not computed");
  EXPECT_FALSE(result.target_from_source);
}

}  // namespace
}  // namespace isthmus
