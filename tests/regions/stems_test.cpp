// Stems: axes that scans from opposite sides agree on, and poses from where they stand.
#include "regions/stems.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pairwise/threads.h"
#include "regions/posts.h"
#include "regions/stem_votes.h"
#include "regions/upright_memo.h"

namespace isthmus {
namespace {

using testing::first_right;
using testing::pose_of;

constexpr float kVoxel = 0.2f;

void add_point(SampledScan& scan, const Eigen::Vector3f& p, const Eigen::Vector3f& n, float variation = 0.02f) {
  scan.points.push_back(p);
  scan.normals.push_back(n);
  scan.variation.push_back(variation);
}

// The side of a trunk that a station in the direction `view_rad` sees; leaning by `lean` along x.
void add_trunk(SampledScan& scan, const Eigen::Vector2f& foot, float radius, float view_rad, float lean = 0,
               float bottom = 0, float top = 4) {
  for (float z = bottom; z < top; z += 0.1f)
    for (float a = view_rad - 1.3f; a <= view_rad + 1.3f; a += 0.25f) {
      const Eigen::Vector3f n(std::cos(a), std::sin(a), 0);
      add_point(scan, Eigen::Vector3f(foot.x() + lean * z, foot.y(), z) + radius * n, n);
    }
}

SampledScan empty_scan() {
  SampledScan scan;
  scan.voxel_m = static_cast<double>(kVoxel);
  return scan;
}

Eigen::Vector2f axis_at(const Stem& s, float z) { return s.centre + (z - s.middle) * s.lean; }

const Eigen::Matrix3f kUp = Eigen::Matrix3f::Identity();

TEST(Stems, BothSidesOfATrunkHaveOneAxis) {
  for (const float radius : {0.08f, 0.15f, 0.25f}) {
    std::vector<Stem> seen;
    for (const float view : {0.3f, 0.3f + std::numbers::pi_v<float>}) {
      SampledScan scan = empty_scan();
      add_trunk(scan, {3.05f, -2.1f}, radius, view);
      const std::vector<Stem> stems = find_stems(scan, kUp, 6);
      ASSERT_EQ(stems.size(), 1u) << radius;
      seen.push_back(stems.front());
    }
    // The surfaces are up to two radii apart; the axes stand where the trunk stands.
    EXPECT_LT((seen[0].centre - seen[1].centre).norm(), 0.35f * kVoxel) << radius;
    for (const Stem& s : seen) EXPECT_LT((s.centre - Eigen::Vector2f(3.05f, -2.1f)).norm(), 0.25f * kVoxel) << radius;
  }
}

TEST(Stems, ALeanIsFollowed) {
  SampledScan scan = empty_scan();
  add_trunk(scan, {1, 1}, 0.15f, 2.0f, 0.12f, 0, 6);
  const std::vector<Stem> stems = find_stems(scan, kUp, 6);
  ASSERT_EQ(stems.size(), 1u);
  EXPECT_NEAR(stems[0].lean.x(), 0.12f, 0.02f);
  EXPECT_NEAR(stems[0].lean.y(), 0, 0.02f);
  EXPECT_LT((axis_at(stems[0], 0) - Eigen::Vector2f(1, 1)).norm(), 0.3f * kVoxel);
  EXPECT_NEAR(stems[0].top, 6, kVoxel);
}

TEST(Stems, WallsGroundAndLowThingsAreNone) {
  SampledScan scan = empty_scan();
  for (float x = 0; x < 5; x += 0.1f)
    for (float z = 0; z < 4; z += 0.1f) add_point(scan, {x, 2, z}, {0, -1, 0});  // a wall
  for (float x = -5; x < 0; x += 0.1f)
    for (float y = -5; y < 0; y += 0.1f) add_point(scan, {x, y, 0}, {0, 0, 1});  // ground
  add_trunk(scan, {-3, 3}, 0.15f, 0, 0, 0, 0.8f);                                // a stump of four voxels
  EXPECT_TRUE(find_stems(scan, kUp, 6).empty());
  EXPECT_EQ(find_stems(scan, kUp, 3).size(), 1u) << "the stump, if so much is asked for";
}

TEST(Stems, ABushHidesAPartAndTheRestIsFound) {
  SampledScan scan = empty_scan();
  add_trunk(scan, {0.1f, 0.1f}, 0.12f, 1, 0, 0, 5);
  Rng rng(3);
  for (int k = 0; k < 900; ++k) {  // around the foot, 1.2 m tall
    const Eigen::Vector3f p(static_cast<float>(rng.uniform(-0.9, 0.9)), static_cast<float>(rng.uniform(-0.9, 0.9)),
                            static_cast<float>(rng.uniform(0, 1.2)));
    const double a = rng.uniform(0, 6.28);
    add_point(scan, p, {static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)), 0}, 0.2f);
  }
  const std::vector<Stem> stems = find_stems(scan, kUp, 6);
  ASSERT_EQ(stems.size(), 1u);
  EXPECT_GT(stems[0].bottom, 1.0f);
  EXPECT_LT((stems[0].centre - Eigen::Vector2f(0.1f, 0.1f)).norm(), 0.3f * kVoxel);
}

TEST(Stems, TheVerticalMayPointAnywhereAndNothingIsFoundInNothing) {
  SampledScan scan = empty_scan();
  EXPECT_TRUE(find_stems(scan, kUp, 6).empty());
  add_trunk(scan, {2, 1}, 0.15f, 0);
  add_point(scan, {7, 7, 1}, {1, 0, 0}, 1.0f);  // no normal
  const Eigen::Matrix3f turn = rotation_from_vector({0.7, -1.1, 0.4}).cast<float>();
  SampledScan turned = scan;
  for (auto& p : turned.points) p = turn * p;
  for (auto& n : turned.normals) n = turn * n;
  const auto straight = find_stems(scan, kUp, 6), other = find_stems(turned, turn.transpose(), 6);
  ASSERT_EQ(straight.size(), 1u);
  ASSERT_EQ(other.size(), 1u);
  EXPECT_LT((straight[0].centre - other[0].centre).norm(), 0.1f * kVoxel) << "but for points on the rims of cells";
}

// Two scans 25 m apart, of one scene or of two.
struct Wood {
  Transform world_from_source = pose_of({-9, 6, 1.7}, {0, 0, 2.2}), world_from_target = pose_of({11, -8, 1.7});
  ScanProduct a, b;
  ScanModel source{a.sampled, a.features, a.regions, ModelLevel::coarse};
  ScanModel target{b.sampled, b.features, b.regions, ModelLevel::coarse};

  Wood(const testing::Scene& at_source, const testing::Scene& at_target)
      : a(product(at_source, world_from_source, 1)), b(product(at_target, world_from_target, 2)) {}
  Wood(const Wood&) = delete;  // the lookups point into the products

  static ScanProduct product(const testing::Scene& scene, const Transform& pose, std::uint64_t seed) {
    testing::SamplingSetup setup;
    setup.options.station = "origin";
    return testing::product_of(testing::scan_scene(scene, pose, {160000, 40, 0.004, seed}), 0.4, setup);
  }
  [[nodiscard]] std::vector<Seed> seeds() const {
    return vote_seeds_by_stems(source, target, Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitZ(), {});
  }
};

TEST(StemVotes, PostsSeenFromOppositeSidesSettleThePair) {
  const testing::Scene plain = testing::posts(5, 0.2);
  const Wood wood(plain, plain);
  const auto run = [&] {
    std::vector<float> out;
    for (const Seed& s : wood.seeds()) {
      out.insert(out.end(), s.rotation.data(), s.rotation.data() + 9);
      out.insert(out.end(), s.centre_in_target.data(), s.centre_in_target.data() + 3);
      out.push_back(s.score);
    }
    return out;
  };
  const auto one = testing::with_threads(1, run);
  EXPECT_EQ(testing::with_threads(2, run), one);
  EXPECT_EQ(testing::with_threads(7, run), one);
  const std::vector<Seed> seeds = wood.seeds();
  EXPECT_EQ(first_right(wood.source, wood.world_from_target.inverse() * wood.world_from_source, seeds), 1);
  EXPECT_TRUE(stems_settle(seeds));
}

TEST(StemVotes, AnotherWoodSettlesNothing) {
  const Wood wood(testing::posts(5, 0.2), testing::posts(6, 0.2));
  EXPECT_FALSE(stems_settle(wood.seeds()));
}

TEST(StemVotes, APlantationOnAGridSettlesNothing) {
  testing::Scene grid = testing::plain_ground();
  for (int x = -9; x <= 9; ++x)
    for (int y = -9; y <= 9; ++y) testing::add_post(grid, {4.0 * x, 4.0 * y, 0}, 0.3 * (x + 2 * y), 0.2);
  const Wood wood(grid, grid);
  const auto seeds = wood.seeds();
  EXPECT_FALSE(stems_settle(seeds)) << "a step of the grid explains nearly as much";
  EXPECT_GT(seeds.size(), 1u);
}

TEST(UprightMemo, MakesOnceWhatIsAskedForTwiceAndACopyBeginsAnew) {
  UprightMemo memo;
  int made = 0;
  const auto make = [&made] { return std::vector<Stem>(static_cast<std::size_t>(++made)); };
  Eigen::Matrix3f turned = kUp;
  turned.topLeftCorner<2, 2>() = Eigen::Rotation2Df(0.1f).toRotationMatrix();
  const auto first = memo.stems(kUp, 6, make);
  EXPECT_EQ(memo.stems(kUp, 6, make), first);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(memo.stems(turned, 6, make)->size(), 2U) << "another vertical";
  EXPECT_EQ(memo.stems(kUp, 5, make)->size(), 3U) << "other options";
  EXPECT_EQ(memo.stems(kUp, 6, make), first);
  UprightMemo copy = memo;  // of a scan that may have been changed since
  EXPECT_EQ(copy.stems(kUp, 6, make)->size(), 4U);
  copy = memo;
  EXPECT_EQ(copy.stems(kUp, 6, make)->size(), 5U);
  EXPECT_EQ(memo.stems(kUp, 6, make), first);

  int plans = 0;
  const auto plan = [&plans] { return ++plans, GroundPlan{}; };
  GroundPlanOptions fewer;
  fewer.max_columns = 250;
  memo.plan(kUp, {}, plan), memo.plan(kUp, {}, plan), memo.plan(kUp, fewer, plan), memo.plan(turned, {}, plan);
  EXPECT_EQ(plans, 3);
}

}  // namespace
}  // namespace isthmus
