// Pairs that a survey should not contain and will: each has its verdict and its reason.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>

#include "pairwise/synthetic_product.h"

namespace isthmus {
namespace {

using testing::furnished_hall;
using testing::kHallVoxel;
using testing::Points;
using testing::pose_of;
using testing::product_of;
using testing::scan_scene;
using testing::Scene;

Points hall_points(const Transform& world_from_scan, std::uint64_t seed, double max_range_m = 9) {
  return scan_scene(furnished_hall(1), world_from_scan, {60000, max_range_m, 0.004, seed});
}

template <class Inside>
Points part_of(const Points& points, const Inside& inside) {
  Points out;
  std::copy_if(points.begin(), points.end(), std::back_inserter(out), inside);
  return out;
}

// What may be said of a pose that the evidence does not carry.
void expect_refused_with_a_reason(const PairResult& r) {
  EXPECT_TRUE(r.verdict == Verdict::rejected || r.verdict == Verdict::ambiguous)
      << to_string(r.verdict) << ": " << r.reason << ", probability " << r.probability;
  const bool named = std::ranges::any_of(
      std::array{"no hypothesis", "is explained", "a rival pose", "saw through", "hardly fixed", "nothing fixes"},
      [&](const char* words) { return r.reason.find(words) != std::string::npos; });
  EXPECT_TRUE(named) << r.reason;
  EXPECT_EQ(r.reason.find("no rival comes near"), std::string::npos) << r.reason;
}

TEST(BadPairs, AnEmptyOverlapIsRefused) {
  // Both ends of one long hall, cut so that no surface is in both.
  const auto west =
      part_of(hall_points(pose_of({-6, 0, 1.7}), 1, 6), [](const Eigen::Vector3f& p) { return p.x() < 4; });
  const auto east =
      part_of(hall_points(pose_of({6, 0, 1.7}), 2, 6), [](const Eigen::Vector3f& p) { return p.x() > -4; });
  expect_refused_with_a_reason(
      register_pair(product_of(west, kHallVoxel), product_of(east, kHallVoxel), PairOptions{}));
}

TEST(BadPairs, AScanOfOnePlaneIsAmbiguousBecauseItSlides) {
  Scene wall;
  wall.add_rectangle({5, -6, -3}, {0, 12, 0}, {0, 0, 6});
  const ScanProduct one = product_of(scan_scene(wall, pose_of({0, 0, 0}), {80000, 7.5, 0.003, 1}), kHallVoxel);
  const ScanProduct two =
      product_of(scan_scene(wall, pose_of({0, 1.5, 0.4}, {0, 0, 0.2}), {80000, 7.5, 0.003, 2}), kHallVoxel);
  const PairResult r = register_pair(one, two, PairOptions{});
  EXPECT_EQ(r.verdict, Verdict::ambiguous) << r.reason << ", probability " << r.probability;
  EXPECT_NE(r.reason.find("nothing fixes"), std::string::npos) << r.reason;
}

// A piece of floor lies on the whole hall's floor anywhere, even where it came from.
TEST(BadPairs, APlaneOutOfAScanIsNotAcceptedInThatScan) {
  const Points whole = hall_points(pose_of({0, 0, 1.7}), 1);
  const Points ceiling = part_of(whole, [](const Eigen::Vector3f& p) { return p.z() < -1.6f; });
  ASSERT_GT(ceiling.size(), 2000u);
  const PairResult r = register_pair(product_of(testing::moved(ceiling, pose_of({0, 0, 0}, {0, 0, 1})), kHallVoxel),
                                     product_of(whole, kHallVoxel), PairOptions{});
  expect_refused_with_a_reason(r);
}

TEST(BadPairs, AScanInsideAnotherIsFound) {
  const Points whole = hall_points(pose_of({0, 0, 1.7}), 1, 1e6);
  const Points part = part_of(whole, [](const Eigen::Vector3f& p) { return p.x() > 1; });
  ASSERT_LT(part.size(), whole.size() / 2);
  const Transform turn = pose_of({0, 0, 0}, {0, 0, 2});
  const ScanProduct inner = product_of(testing::moved(part, turn), kHallVoxel), outer = product_of(whole, kHallVoxel);
  const PairResult r = register_pair(inner, outer, PairOptions{});
  EXPECT_EQ(r.verdict, Verdict::accepted) << r.reason << ", probability " << r.probability;
  ASSERT_TRUE(r.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(inner, *r.target_from_source, turn.inverse()), 0.25 * kHallVoxel);
  EXPECT_GT(r.overlap_of_source, 0.9);
  EXPECT_LT(r.overlap_of_target, 0.6);
  EXPECT_NE(r.reason.find("no rival comes near"), std::string::npos) << r.reason;
}

TEST(BadPairs, TwoCopiesOfOneScanLieOnEachOther) {
  const ScanProduct scan = product_of(hall_points(pose_of({1, 0.5, 1.7}), 1), kHallVoxel);
  const PairResult r = register_pair(scan, scan, PairOptions{});
  EXPECT_EQ(r.verdict, Verdict::accepted) << r.reason << ", probability " << r.probability;
  ASSERT_TRUE(r.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(scan, *r.target_from_source, Transform::Identity()), 0.05 * kHallVoxel);
  EXPECT_GT(r.overlap, 0.95);
  EXPECT_NE(r.reason.find("no rival comes near"), std::string::npos) << r.reason;
}

// Every distance between two points is right, every plane, every corner but its hand.
TEST(BadPairs, AMirroredScanDoesNotRegister) {
  const Points points = hall_points(pose_of({1, 0.7, 1.8}), 2);
  Points mirrored = points;
  for (auto& p : mirrored) p.y() = -p.y();
  expect_refused_with_a_reason(
      register_pair(product_of(mirrored, kHallVoxel), product_of(points, kHallVoxel), PairOptions{}));
}

// As numbers, a hall in millimetres is a thousand halls wide: at the voxel of the others it has no surface, and the
// error says to look at the unit. (Sizes of whole scans are compared before that, see survey/unit_check.)
TEST(BadPairs, MillimetresAtAVoxelInMetresAreNamed) {
  Points millimetres = hall_points(pose_of({0, 0, 1.7}), 1);
  for (auto& p : millimetres) p *= 1000;
  const auto scan = testing::try_sampling(millimetres, kHallVoxel);
  ASSERT_FALSE(scan);
  EXPECT_NE(scan.error().text().find("unit"), std::string::npos) << scan.error().text();
}

// Clutter as dense as half of all points, evenly in the air.
TEST(BadPairs, ScansOfWhichHalfFloatsInTheAirAreLaidRight) {
  const Transform from = pose_of({-2, -0.5, 1.7}), to = pose_of({2, 0.5, 1.8}, {0, 0, 1.3});
  const ScanProduct source = product_of(testing::with_clutter(hall_points(from, 1), 0.5, 5), kHallVoxel);
  const ScanProduct target = product_of(testing::with_clutter(hall_points(to, 2), 0.5, 6), kHallVoxel);
  const PairResult r = register_pair(source, target, PairOptions{});
  EXPECT_TRUE(r.verdict == Verdict::accepted || r.verdict == Verdict::ambiguous) << r.reason;
  EXPECT_GT(r.probability, 0.8) << r.reason;
  ASSERT_TRUE(r.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(source, *r.target_from_source, to.inverse() * from), kHallVoxel);
}

}  // namespace
}  // namespace isthmus
