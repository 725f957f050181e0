#include "regions/seeds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pairwise/threads.h"
#include "regions/hall_pair.h"

namespace isthmus {
namespace {

using testing::HallPair;
using testing::pose_of;
using testing::seed_at;
using testing::share_in_overlap;

Transform random_motion(Rng& rng) {
  return pose_of({rng.uniform(-6, 6), rng.uniform(-5, 5), rng.uniform(-1, 1)},
                 {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-3, 3)});
}

TEST(Seed, PutsItsRegionWhereItSays) {
  const HallPair pair;
  const Seed seed = seed_at(pair.source, 3, pair.data.target_from_source);
  const Eigen::Vector3f centre = pair.source.regions.regions[3].centre;
  EXPECT_LT((seed.target_from_source(pair.source) * centre - seed.centre_in_target).norm(), 1e-4f);
}

TEST(ScoreSeeds, TheTruthScoresAboveRandomPlaces) {
  const HallPair pair;
  Rng rng(5);
  std::vector<Seed> seeds;
  std::vector<std::uint32_t> true_seeds;
  for (std::uint32_t r = 0; r < pair.source.regions.regions.size(); ++r) {
    if (share_in_overlap(pair, r, 3, pair.data.target_from_source) < 0.7) continue;
    true_seeds.push_back(static_cast<std::uint32_t>(seeds.size()));
    seeds.push_back(seed_at(pair.source, r, pair.data.target_from_source));
    for (int k = 0; k < 20; ++k)
      seeds.push_back(seed_at(pair.source, r, random_motion(rng) * pair.data.target_from_source));
  }
  ASSERT_GT(true_seeds.size(), 5u);
  score_seeds(pair.source, pair.target, {}, seeds);
  std::size_t first = 0;
  for (const std::uint32_t t : true_seeds)
    first += std::all_of(seeds.begin() + t + 1, seeds.begin() + t + 21,
                         [&](const Seed& s) { return s.score < seeds[t].score; });
  EXPECT_GE(first, true_seeds.size() * 9 / 10);
  for (const Seed& s : seeds) EXPECT_TRUE(std::isfinite(s.score));
}

// What every placement of a region explains says nothing about which one is right.
TEST(ScoreSeeds, CommonSupportWeighsLessThanRareSupport) {
  const HallPair pair;
  const Transform truth = pair.data.target_from_source;
  std::uint32_t region = 0;
  for (std::uint32_t r = 0; r < pair.source.regions.regions.size(); ++r)
    if (share_in_overlap(pair, r, 3, truth) > share_in_overlap(pair, region, 3, truth)) region = r;
  std::vector<Seed> alone{seed_at(pair.source, region, truth)}, crowd(30, alone[0]);
  Rng rng(3);
  for (int k = 0; k < 29; ++k) alone.push_back(seed_at(pair.source, region, random_motion(rng) * truth));
  score_seeds(pair.source, pair.target, {}, alone);
  score_seeds(pair.source, pair.target, {}, crowd);
  EXPECT_GT(alone[0].score, 2 * crowd[0].score);
}

TEST(ScoreSeeds, NoSeedsNoHarmAndTheSameForAnyNumberOfThreads) {
  const HallPair pair;
  std::vector<Seed> none;
  score_seeds(pair.source, pair.target, {}, none);
  Rng rng(6);
  std::vector<Seed> seeds;
  for (std::uint32_t r = 0; r < pair.source.regions.regions.size(); ++r)
    for (int k = 0; k < 10; ++k) seeds.push_back(seed_at(pair.source, r, random_motion(rng)));
  const auto scores = [&] {
    std::vector<Seed> mine = seeds;
    score_seeds(pair.source, pair.target, {}, mine);
    std::vector<float> out;
    for (const Seed& s : mine) out.push_back(s.score);
    return out;
  };
  EXPECT_EQ(testing::with_threads(1, scores), testing::with_threads(7, scores));
}

TEST(DistinctSeeds, BestFirstTwinsMergedNoMoreThanWanted) {
  const HallPair pair;
  const Transform truth = pair.data.target_from_source;
  std::vector<Seed> seeds;
  const auto add = [&](const Transform& t, float score, float votes) {
    seeds.push_back(seed_at(pair.source, 0, t));
    seeds.back().score = score;
    seeds.back().votes = votes;
  };
  add(truth, 0.2f, 1);
  add(pose_of({5, 0, 0}) * truth, 0.5f, 2);
  add(pose_of({0.05, 0, 0}) * truth, 0.9f, 4);  // the first one again, better scored
  add(pose_of({0, 0, 0}, {0, 0, 1}) * truth, 0.1f, 8);
  const auto kept = best_distinct_seeds(pair.source, seeds, 0.5f, 0.1f, 10);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0].score, 0.9f);
  EXPECT_EQ(kept[0].votes, 5) << "its own votes and its twin's";
  EXPECT_EQ(kept[1].score, 0.5f);
  EXPECT_EQ(kept[2].score, 0.1f);
  EXPECT_EQ(best_distinct_seeds(pair.source, seeds, 0.5f, 0.1f, 2).size(), 2u);
  EXPECT_TRUE(best_distinct_seeds(pair.source, {}, 0.5f, 0.1f, 2).empty());
}

TEST(DistinctSeeds, SeedsOfDifferentRegionsWithOnePoseAreOne) {
  const HallPair pair;
  std::vector<Seed> seeds;
  for (std::uint32_t r = 0; r < pair.source.regions.regions.size(); ++r)
    seeds.push_back(seed_at(pair.source, r, pair.data.target_from_source));
  EXPECT_EQ(best_distinct_seeds(pair.source, seeds, 0.3f, 0.1f, 100).size(), 1u);
}

}  // namespace
}  // namespace isthmus
