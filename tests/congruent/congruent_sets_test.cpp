#include "congruent/congruent_sets.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

constexpr std::size_t kNoLimit = 100000000;

std::vector<CongruentSet> brute_force(const SetQuery& query, const test::Cloud& cloud, const std::vector<PointPair>& ab,
                                      const std::vector<PointPair>& cd) {
  std::vector<CongruentSet> sets;
  for (const PointPair p : ab)
    for (const PointPair q : cd)
      if (are_congruent(query, cloud.points, cloud.normals, p, q))
        sets.push_back({p.first, p.second, q.first, q.second});
  std::sort(sets.begin(), sets.end());
  return sets;
}

std::vector<CongruentSet> sorted_answer(const SetQuery& query, const test::Cloud& cloud,
                                        const std::vector<PointPair>& ab, const std::vector<PointPair>& cd,
                                        SetCounts& counts) {
  auto sets = find_congruent_sets(query, cloud.points, cloud.normals, ab, cd, kNoLimit, counts);
  if (!sets) return {};
  std::sort(sets->begin(), sets->end());
  return *sets;
}

std::vector<PointPair> random_pairs(std::size_t num_points, std::size_t count, Rng& rng) {
  std::vector<PointPair> pairs;
  while (pairs.size() < count) {
    const auto i = static_cast<std::uint32_t>(rng.below(num_points)),
               j = static_cast<std::uint32_t>(rng.below(num_points));
    if (i != j) pairs.push_back({i, j});
  }
  return pairs;
}

TEST(CongruentSets, FindsTheOneCrossInASquareWithADecoy) {
  test::Cloud cloud;
  cloud.points = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {5, 1.4F, 0}};
  const std::vector<PointPair> ab{{0, 1}, {4, 5}}, cd{{2, 3}, {5, 4}};
  const SetQuery query{.r1 = 0.5, .r2 = 0.5, .max_gap_m = 0.01, .angle = cosines_near(0, 0.1), .between_normals = {}};
  SetCounts counts;
  EXPECT_EQ(sorted_answer(query, cloud, ab, cd, counts), (std::vector<CongruentSet>{{0, 1, 2, 3}}));
}

TEST(CongruentSets, EqualsBruteForceAtAnyAngleAndGap) {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const auto cloud = test::random_cube(200, 2, seed);
    const auto ab = random_pairs(200, 1500, rng), cd = random_pairs(200, 1500, rng);
    SetQuery query{.r1 = rng.uniform(0.1, 0.9),
                   .r2 = rng.uniform(0.1, 0.9),
                   .max_gap_m = rng.uniform(0.01, 0.3),
                   .angle = cosines_near(rng.uniform(-1, 1), rng.uniform(0.02, 0.8)),
                   .between_normals = {}};
    for (auto& interval : query.between_normals) interval = cosines_near(rng.uniform(-0.5, 0.5), 1.4);
    SetCounts counts;
    const auto expected = brute_force(query, cloud, ab, cd);
    EXPECT_EQ(sorted_answer(query, cloud, ab, cd, counts), expected) << seed;
    EXPECT_LT(counts.gap_tests, ab.size() * cd.size() / 4) << "hardly better than brute force";
    found += expected.size();
  }
  EXPECT_GT(found, 1000U) << "the comparison must not be between empty lists";
}

TEST(CongruentSets, WorkFollowsPositionAndDirection) {
  Rng rng(4);
  const auto cloud = test::random_cube(400, 2, 4);
  const auto ab = random_pairs(400, 4000, rng), cd = random_pairs(400, 4000, rng);
  SetQuery query{.r1 = 0.5, .r2 = 0.5, .max_gap_m = 0.1, .angle = {}, .between_normals = {}};
  SetCounts any, narrow;
  sorted_answer(query, cloud, ab, cd, any);
  query.angle = cosines_near(0.9, 0.05);
  sorted_answer(query, cloud, ab, cd, narrow);
  EXPECT_LT(any.gap_tests, 4000U * 4000U / 50);
  EXPECT_LT(narrow.gap_tests, any.gap_tests / 3) << "directions are not used";
}

TEST(CongruentSets, DegenerateInput) {
  test::Cloud cloud;
  cloud.points.assign(6, Eigen::Vector3f(1, 1, 1));
  const SetQuery query{.r1 = 0.5, .r2 = 0.5, .max_gap_m = 0.1, .angle = {}, .between_normals = {}};
  SetCounts counts;
  EXPECT_TRUE(sorted_answer(query, cloud, {}, {{0, 1}}, counts).empty());
  EXPECT_TRUE(sorted_answer(query, cloud, {{0, 1}}, {}, counts).empty());
  EXPECT_TRUE(sorted_answer(query, cloud, {{0, 1}}, {{1, 2}}, counts).empty()) << "a point may not be two corners";
  EXPECT_EQ(sorted_answer(query, cloud, {{0, 1}}, {{2, 3}}, counts).size(), 1U) << "coincident points, open angle";
}

TEST(CongruentSets, GivesNothingAboveTheCapAndEverythingAtIt) {
  Rng rng(9);
  const auto cloud = test::random_cube(100, 1, 9);
  const auto ab = random_pairs(100, 500, rng), cd = random_pairs(100, 500, rng);
  const SetQuery query{.r1 = 0.5, .r2 = 0.5, .max_gap_m = 0.1, .angle = {}, .between_normals = {}};
  SetCounts counts;
  const std::size_t all = sorted_answer(query, cloud, ab, cd, counts).size();
  ASSERT_GT(all, 10U);
  EXPECT_TRUE(find_congruent_sets(query, cloud.points, cloud.normals, ab, cd, all, counts));
  EXPECT_FALSE(find_congruent_sets(query, cloud.points, cloud.normals, ab, cd, all - 1, counts));
}

}  // namespace
}  // namespace isthmus::congruent
