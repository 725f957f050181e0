// The two generators of initial overlapped sub-regions on a hall seen twice.
#include <gtest/gtest.h>

#include <algorithm>

#include "pairwise/threads.h"
#include "regions/hall_pair.h"
#include "regions/pair_votes.h"
#include "regions/pose_votes.h"

namespace isthmus {
namespace {

using testing::HallPair;

constexpr std::uint32_t kMatches = 48;

struct Closeness {
  double centre_voxels = 1e9, rotation_deg = 1e9;
};

Closeness closeness(const HallPair& pair, const Seed& seed) {
  const Transform t = transform_of(seed.target_from_source(pair.source));
  const Eigen::Vector3d centre = pair.source.regions.regions[seed.source_region].centre.cast<double>();
  return {displacement_m(t, pair.data.target_from_source, centre) / static_cast<double>(pair.source.voxel_m),
          rotation_angle_rad(t.linear().transpose() * pair.data.target_from_source.linear()) * 180 / 3.14159265};
}

std::size_t num_right(const HallPair& pair, const std::vector<Seed>& seeds) {
  return static_cast<std::size_t>(std::count_if(seeds.begin(), seeds.end(), [&](const Seed& s) {
    const Closeness c = closeness(pair, s);
    return c.centre_voxels < 4 && c.rotation_deg < 12;
  }));
}

void expect_sound(const HallPair& pair, const std::vector<Seed>& seeds, std::uint32_t most_per_region) {
  std::vector<std::uint32_t> count(pair.source.regions.regions.size(), 0);
  for (const Seed& s : seeds) {
    ASSERT_LT(s.source_region, count.size());
    ++count[s.source_region];
    EXPECT_NEAR(s.rotation.determinant(), 1, 1e-3);
    EXPECT_LT((s.rotation.transpose() * s.rotation - Eigen::Matrix3f::Identity()).norm(), 1e-3f);
    EXPECT_TRUE(s.centre_in_target.allFinite());
    EXPECT_GT(s.votes, 0);
    EXPECT_STRNE(s.generator, "");
  }
  for (const std::uint32_t n : count) EXPECT_LE(n, most_per_region);
}

TEST(AxisVotes, ProposeTheTruthUnderAnyHeading) {
  for (const double yaw : {0.0, 1.3, -2.9}) {
    const HallPair pair({0, 0, yaw});
    const MatchTable matches = match_descriptors(pair.source.features, pair.target.features, kMatches);
    const VoteOptions options;
    const auto seeds = vote_seeds_about_axis(pair.source, pair.target, matches, Eigen::Vector3f::UnitZ(),
                                             Eigen::Vector3f::UnitZ(), options);
    expect_sound(pair, seeds, options.peaks_per_region);
    EXPECT_GE(num_right(pair, seeds), 2u) << "yaw " << yaw;
    for (const Seed& s : seeds) EXPECT_GT(s.rotation(2, 2), 0.999f) << "turned about the axis only";
  }
}

TEST(AxisVotes, TheAxisMayPointAnywhere) {
  const Eigen::Vector3d turn(2.0, -1.1, 0.6);
  const HallPair pair(turn);
  const Eigen::Vector3f up_in_source =
      (rotation_from_vector(turn).transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
  const MatchTable matches = match_descriptors(pair.source.features, pair.target.features, kMatches);
  const auto seeds =
      vote_seeds_about_axis(pair.source, pair.target, matches, up_in_source, Eigen::Vector3f::UnitZ(), {});
  EXPECT_GE(num_right(pair, seeds), 2u);
  const auto upside_down =
      vote_seeds_about_axis(pair.source, pair.target, matches, -up_in_source, Eigen::Vector3f::UnitZ(), {});
  EXPECT_EQ(num_right(pair, upside_down), 0u);
}

TEST(PairVotes, ProposeTheTruthUnderAnyRotation) {
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 0.7), Eigen::Vector3d(1.9, 0.8, -1.4), Eigen::Vector3d(-0.6, 2.4, 1)}) {
    const HallPair pair(turn);
    const MatchTable matches = match_descriptors(pair.source.features, pair.target.features, kMatches);
    const PairVoteOptions options;
    const auto seeds = vote_seeds_by_pairs(pair.source, pair.target, matches, options);
    expect_sound(pair, seeds, options.peaks_per_region);
    EXPECT_GE(num_right(pair, seeds), 2u) << turn.transpose();
  }
}

TEST(Votes, RightMatchesGiveTheExactPose) {
  // The target is the source itself, moved; every keypoint's first match is its twin.
  const HallPair pair;
  const Transform t = testing::pose_of({3, -2, 0.5}, {0.4, 0.2, 1.5});
  ScanProduct moved = pair.data.source;
  moved.sampled.points = testing::moved(moved.sampled.points, t);
  for (auto& n : moved.sampled.normals) n = (t.linear() * n.cast<double>()).cast<float>();
  const ScanModel target(moved.sampled, moved.features, moved.regions, ModelLevel::coarse);
  MatchTable twins;
  twins.count = 1;
  for (std::uint32_t k = 0; k < moved.features.keypoints.size(); ++k)
    twins.target.push_back(k), twins.similarity.push_back(1);
  const Eigen::Vector3f axis = Eigen::Vector3f::UnitZ(),
                        axis_there = (t.linear() * Eigen::Vector3d::UnitZ()).cast<float>();
  for (const auto& seeds : {vote_seeds_about_axis(pair.source, target, twins, axis, axis_there, {}),
                            vote_seeds_by_pairs(pair.source, target, twins, {})}) {
    std::vector<const Seed*> best(pair.source.regions.regions.size(), nullptr);
    for (const Seed& s : seeds)
      if (!best[s.source_region] || s.votes > best[s.source_region]->votes) best[s.source_region] = &s;
    std::size_t exact = 0, voted = 0;
    for (const Seed* s : best) {
      if (!s) continue;
      ++voted;
      const Transform found = transform_of(s->target_from_source(pair.source));
      exact += rotation_angle_rad(found.linear().transpose() * t.linear()) < 0.05 &&
               displacement_m(found, t, pair.source.regions.regions[s->source_region].centre.cast<double>()) < 0.3;
    }
    EXPECT_GT(voted, best.size() / 2);
    EXPECT_GE(exact, voted * 9 / 10) << seeds.front().generator;
  }
}

TEST(Votes, WithoutMatchesOrKeypointsThereAreNoSeeds) {
  const HallPair pair;
  ScanProduct bare = pair.data.target;
  bare.features = {};
  bare.features.dimension = pair.data.source.features.dimension;
  bare.regions = {};
  const ScanModel empty(bare.sampled, bare.features, bare.regions, ModelLevel::coarse);
  const auto up = Eigen::Vector3f::UnitZ();
  const MatchTable to_nothing = match_descriptors(pair.source.features, empty.features, kMatches);
  EXPECT_TRUE(vote_seeds_about_axis(pair.source, empty, to_nothing, up, up, {}).empty());
  EXPECT_TRUE(vote_seeds_by_pairs(pair.source, empty, to_nothing, {}).empty());
  const MatchTable from_nothing = match_descriptors(empty.features, pair.target.features, kMatches);
  EXPECT_TRUE(vote_seeds_about_axis(empty, pair.target, from_nothing, up, up, {}).empty());
  EXPECT_TRUE(vote_seeds_by_pairs(empty, pair.target, from_nothing, {}).empty());
}

TEST(Votes, TheSameForAnyNumberOfThreads) {
  const HallPair pair;
  const MatchTable matches = match_descriptors(pair.source.features, pair.target.features, kMatches);
  const auto up = Eigen::Vector3f::UnitZ();
  const auto run = [&] {
    auto seeds = vote_seeds_about_axis(pair.source, pair.target, matches, up, up, {});
    const auto more = vote_seeds_by_pairs(pair.source, pair.target, matches, {});
    seeds.insert(seeds.end(), more.begin(), more.end());
    std::vector<float> numbers;
    for (const Seed& s : seeds) {
      numbers.insert(numbers.end(), s.rotation.data(), s.rotation.data() + 9);
      numbers.insert(numbers.end(), s.centre_in_target.data(), s.centre_in_target.data() + 3);
      numbers.push_back(s.votes);
    }
    return numbers;
  };
  EXPECT_EQ(testing::with_threads(1, run), testing::with_threads(7, run));
}

}  // namespace
}  // namespace isthmus
