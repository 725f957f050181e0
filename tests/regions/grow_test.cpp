#include "regions/grow.h"

#include <gtest/gtest.h>

#include "regions/hall_pair.h"

namespace isthmus {
namespace {

using testing::HallPair;
using testing::pose_of;
using testing::seed_at;
using testing::share_in_overlap;

// The truth, turned by `angle_rad` about the region's centre and shifted.
Transform disturbed(const HallPair& pair, std::uint32_t region, double angle_rad, double shift_m, Rng& rng) {
  const auto direction = [&] { return Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized(); };
  const Transform& truth = pair.data.target_from_source;
  const Eigen::Vector3d centre = truth * pair.source.regions.regions[region].centre.cast<double>();
  const Transform turn = pose_of(centre) * pose_of(shift_m * direction(), angle_rad * direction()) * pose_of(-centre);
  return turn * truth;
}

TEST(Grow, RecoversFromFiveDegreesAndThreeVoxels) {
  const HallPair pair;
  Rng rng(4);
  int tried = 0, recovered = 0;
  for (std::uint32_t r = 0; r < pair.source.regions.regions.size(); ++r) {
    if (share_in_overlap(pair, r, 3, pair.data.target_from_source) < 0.7) continue;
    const Transform start = disturbed(pair, r, 5 * 3.14159265 / 180, 3 * testing::kHallVoxel, rng);
    const GrownOverlap grown = grow(pair.source, pair.target, seed_at(pair.source, r, start), {});
    ++tried;
    recovered += testing::largest_displacement_m(pair.data.source, grown.target_from_source,
                                                 pair.data.target_from_source) < testing::kHallVoxel;
  }
  ASSERT_GE(tried, 6);
  EXPECT_GE(recovered, tried * 2 / 3) << recovered << " of " << tried;
}

TEST(Grow, AtTheTruthItStaysAndTellsTheOverlap) {
  const HallPair pair;
  std::uint32_t region = 0;
  for (std::uint32_t r = 0; r < pair.source.regions.regions.size(); ++r)
    if (share_in_overlap(pair, r, 3, pair.data.target_from_source) >
        share_in_overlap(pair, region, 3, pair.data.target_from_source))
      region = r;
  const GrownOverlap grown =
      grow(pair.source, pair.target, seed_at(pair.source, region, pair.data.target_from_source), {});
  EXPECT_LT(testing::largest_displacement_m(pair.data.source, grown.target_from_source, pair.data.target_from_source),
            0.5 * testing::kHallVoxel);
  EXPECT_GT(grown.matches, 50u);
  EXPECT_GT(grown.rms_m, 0);
  EXPECT_LT(grown.rms_m, testing::kHallVoxel);
  const DirectedScore there =
      score_direction(pair.source, pair.target, pose3f(pair.data.target_from_source), {}, 1, false);
  EXPECT_NEAR(grown.source_in_target.support, there.support, 0.05);
  EXPECT_EQ(grown.score, ranking_score(grown.source_in_target, grown.target_in_source));
}

TEST(Grow, WhereNothingLiesThePoseIsKept) {
  const HallPair pair;
  const Transform nowhere = pose_of({500, 0, 0}) * pair.data.target_from_source;
  const GrownOverlap grown = grow(pair.source, pair.target, seed_at(pair.source, 0, nowhere), {});
  EXPECT_EQ(grown.matches, 0u);
  EXPECT_EQ(grown.source_in_target.support, 0);
  EXPECT_LT(displacement_m(grown.target_from_source, nowhere, {0, 0, 0}), 1e-3);
}

TEST(RankingScore, SupportRaisesItContradictionLowersIt) {
  const DirectedScore none{}, some{0.3f, 0, 0}, more{0.5f, 0, 0}, blocked{0.5f, 0.1f, 0};
  EXPECT_GT(ranking_score(more, more), ranking_score(some, some));
  EXPECT_GT(ranking_score(some, some), ranking_score(more, none)) << "both sides must see it";
  EXPECT_LT(ranking_score(blocked, more), ranking_score(more, more));
  EXPECT_LT(ranking_score(more, blocked), ranking_score(more, more));
  EXPECT_EQ(ranking_score(some, more), ranking_score(more, some));
}

}  // namespace
}  // namespace isthmus
