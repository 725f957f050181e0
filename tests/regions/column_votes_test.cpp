// The generator from columns: on a hall and in a wood, where descriptors tell little.
#include "regions/column_votes.h"

#include <gtest/gtest.h>

#include "pairwise/threads.h"
#include "regions/posts.h"

namespace isthmus {
namespace {

using testing::first_right;
using testing::HallPair;
using testing::pose_of;

TEST(ColumnVotes, RankTheTruthFirstInAHallUnderAnyHeading) {
  for (const double yaw : {0.0, 1.3, -2.9}) {
    const HallPair pair({0, 0, yaw});
    const auto seeds =
        vote_seeds_by_columns(pair.source, pair.target, Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitZ(), {});
    const int rank = first_right(pair.source, pair.data.target_from_source, seeds);
    EXPECT_TRUE(rank >= 1 && rank <= 3) << "yaw " << yaw << ", rank " << rank;
    for (std::size_t k = 1; k < seeds.size(); ++k) EXPECT_GE(seeds[k - 1].score, seeds[k].score);
    for (const Seed& s : seeds) EXPECT_GT(s.rotation(2, 2), 0.999f) << "turned about the axis only";
  }
}

TEST(ColumnVotes, TheAxisMayPointAnywhereAndUpsideDownIsWrong) {
  const Eigen::Vector3d turn(2.0, -1.1, 0.6);
  const HallPair pair(turn);
  const Eigen::Vector3f up = (rotation_from_vector(turn).transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
  const auto seeds = vote_seeds_by_columns(pair.source, pair.target, up, Eigen::Vector3f::UnitZ(), {});
  const int rank = first_right(pair.source, pair.data.target_from_source, seeds);
  EXPECT_TRUE(rank >= 1 && rank <= 3) << rank;
  const auto over = vote_seeds_by_columns(pair.source, pair.target, -up, Eigen::Vector3f::UnitZ(), {});
  EXPECT_EQ(first_right(pair.source, pair.data.target_from_source, over), 0);
}

TEST(ColumnVotes, PostsInAPlainAreFoundByWhereTheyStand) {
  const testing::Scene plain = testing::posts(5, 0.4);
  const Transform world_from_source = pose_of({-5, 2, 1.7}, {0, 0, 2.2}), world_from_target = pose_of({4, -3, 1.7});
  testing::SamplingSetup setup;
  setup.options.station = "origin";
  const ScanProduct a =
      testing::product_of(testing::scan_scene(plain, world_from_source, {120000, 25, 0.004, 1}), 0.4, setup);
  const ScanProduct b =
      testing::product_of(testing::scan_scene(plain, world_from_target, {120000, 25, 0.004, 2}), 0.4, setup);
  const ScanModel source(a.sampled, a.features, a.regions, ModelLevel::coarse);
  const ScanModel target(b.sampled, b.features, b.regions, ModelLevel::coarse);
  const auto seeds = vote_seeds_by_columns(source, target, Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitZ(), {});
  const int rank = first_right(source, world_from_target.inverse() * world_from_source, seeds);
  EXPECT_TRUE(rank >= 1 && rank <= 10) << rank;
}

TEST(ColumnVotes, NothingUprightNoSeedsAndTheSameForAnyNumberOfThreads) {
  const ScanProduct flat = testing::bare_floor();
  const ScanModel model(flat.sampled, flat.features, flat.regions, ModelLevel::coarse);
  EXPECT_TRUE(vote_seeds_by_columns(model, model, Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitZ(), {}).empty());

  const HallPair pair;
  const auto run = [&] {
    std::vector<float> out;
    for (const Seed& s :
         vote_seeds_by_columns(pair.source, pair.target, Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitZ(), {})) {
      out.insert(out.end(), s.rotation.data(), s.rotation.data() + 9);
      out.insert(out.end(), s.centre_in_target.data(), s.centre_in_target.data() + 3);
      out.push_back(s.score), out.push_back(static_cast<float>(s.source_region));
    }
    return out;
  };
  const auto one = testing::with_threads(1, run);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(testing::with_threads(2, run), one);
  EXPECT_EQ(testing::with_threads(7, run), one);
}

}  // namespace
}  // namespace isthmus
