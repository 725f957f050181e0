#include "congruent/pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

constexpr std::size_t kNoLimit = 100000000;

bool role_allows(const std::vector<std::uint8_t>& roles, PointPair pair) {
  return roles.empty() || ((roles[pair.first] & kFirstRole) != 0 && (roles[pair.second] & kSecondRole) != 0);
}

std::vector<PointPair> brute_force(const test::Cloud& cloud, const PairQuery& query,
                                   const std::vector<std::uint8_t>& roles) {
  std::vector<PointPair> pairs;
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i)
    for (std::uint32_t j = 0; j < cloud.points.size(); ++j)
      if (i != j && role_allows(roles, {i, j}) && answers(query, cloud.points, cloud.normals, {i, j}))
        pairs.push_back({i, j});
  return pairs;
}

std::vector<PointPair> sorted_answer(const test::Cloud& cloud, const PairQuery& query,
                                     const std::vector<std::uint8_t>& roles) {
  PairCounts counts;
  auto pairs = PairIndex(cloud.points, cloud.normals).find(query, roles, kNoLimit, counts);
  if (!pairs) return {};
  std::sort(pairs->begin(), pairs->end());
  return *pairs;
}

TEST(PairIndex, FindsTheSidesOfAUnitSquareBothWays) {
  test::Cloud square;
  square.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto sides = sorted_answer(square, {.min_distance_m = 0.9F, .max_distance_m = 1.1F}, {});
  EXPECT_EQ(sides, (std::vector<PointPair>{{0, 1}, {0, 3}, {1, 0}, {1, 2}, {2, 1}, {2, 3}, {3, 0}, {3, 2}}));
  EXPECT_EQ(sorted_answer(square, {.min_distance_m = 1.4F, .max_distance_m = 1.5F}, {}).size(), 4U);
}

TEST(PairIndex, EqualsBruteForceOnAnyDistance) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Rng rng(seed);
    auto cloud = seed % 2 == 0 ? test::random_cube(300, 2, seed) : test::sample_yard(0.35, 0.01, 0.1, seed);
    cloud.normals.clear();
    const auto distance = static_cast<float>(rng.uniform(0.05, 3)), eps = static_cast<float>(rng.uniform(0, 0.3));
    const PairQuery query{.min_distance_m = std::max(0.0F, distance - eps), .max_distance_m = distance + eps};
    EXPECT_EQ(sorted_answer(cloud, query, {}), brute_force(cloud, query, {})) << seed;
  }
}

TEST(PairIndex, EqualsBruteForceWithNormalsHeightsAndRoles) {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Rng rng(seed + 100);
    const auto cloud = test::sample_yard(0.3, 0.01, 0.1, seed);
    PairQuery query{.min_distance_m = 0.8F, .max_distance_m = 1.3F};
    query.between_normals = cosines_near(rng.uniform(-0.5, 0.9), 0.6);
    query.first_normal = cosines_near(rng.uniform(-0.5, 0.5), 0.7);
    query.second_normal = cosines_near(rng.uniform(-0.5, 0.5), 0.7);
    query.up = {0, 0, 1};
    query.min_rise_m = -0.5F, query.max_rise_m = 0.9F;
    std::vector<std::uint8_t> roles;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) roles.push_back(static_cast<std::uint8_t>(rng.below(4)));
    const auto expected = brute_force(cloud, query, roles);
    EXPECT_EQ(sorted_answer(cloud, query, roles), expected) << seed;
    found += expected.size();
  }
  EXPECT_GT(found, 1000U) << "the comparison must not be between empty lists";
}

TEST(PairIndex, DegenerateCloudsGiveWhatBruteForceGives) {
  const PairQuery query{.min_distance_m = 0.5F, .max_distance_m = 1.5F};
  test::Cloud cloud;
  for (int n = 0; n < 4; ++n) {
    EXPECT_EQ(sorted_answer(cloud, query, {}), brute_force(cloud, query, {})) << n << " points";
    cloud.points.emplace_back(static_cast<float>(n), 0.0F, 0.0F);
  }
  cloud.points.assign(40, Eigen::Vector3f(3, 2, 1));
  EXPECT_TRUE(sorted_answer(cloud, query, {}).empty()) << "all equal";
  const PairQuery zero{.min_distance_m = 0, .max_distance_m = 0.1F};
  EXPECT_EQ(sorted_answer(cloud, zero, {}).size(), 40U * 39U) << "all equal, distance 0";
  cloud.points.clear();
  for (int i = 0; i < 60; ++i) cloud.points.emplace_back(0.1F * static_cast<float>(i), 0.0F, 0.0F);
  EXPECT_EQ(sorted_answer(cloud, query, {}), brute_force(cloud, query, {})) << "collinear";
}

TEST(PairIndex, GivesNothingAboveTheCapAndEverythingAtIt) {
  const auto cloud = test::random_cube(200, 1, 3);
  const PairQuery query{.min_distance_m = 0.4F, .max_distance_m = 0.5F};
  const std::size_t all = sorted_answer(cloud, query, {}).size();
  ASSERT_GT(all, 100U);
  PairCounts counts;
  const PairIndex index(cloud.points, cloud.normals);
  EXPECT_TRUE(index.find(query, {}, all, counts));
  EXPECT_FALSE(index.find(query, {}, all - 1, counts));
}

// The work follows the pairs found: on a surface at fixed eps / d, points and pairs grow together and the tests of
// either kind stay within a fixed multiple of points + pairs, while all pairs grow with the square.
TEST(PairIndex, WorkFollowsTheOutput) {
  for (const double spacing : {0.3, 0.15, 0.075}) {
    auto cloud = test::sample_yard(spacing, 0, 0, 1);
    cloud.normals.clear();
    const auto eps = static_cast<float>(spacing);
    const PairQuery query{.min_distance_m = 2 - eps, .max_distance_m = 2 + eps};
    PairCounts counts;
    const auto pairs = PairIndex(cloud.points, {}).find(query, {}, kNoLimit, counts);
    ASSERT_TRUE(pairs);
    const auto output = static_cast<double>(cloud.points.size() + pairs->size());
    EXPECT_LT(static_cast<double>(counts.distance_tests), 2 * output) << cloud.points.size();
    EXPECT_LT(static_cast<double>(counts.cell_tests), 4 * output) << cloud.points.size();
  }
}

TEST(PairIndex, RolesNearTwoPlacesCostLittle) {
  const auto cloud = test::sample_yard(0.1, 0, 0, 1);
  const Eigen::Vector3f a(-2, 1.5F, 0), b(0.5F, -1, 0);
  std::vector<std::uint8_t> roles;
  for (const auto& p : cloud.points)
    roles.push_back(static_cast<std::uint8_t>(((p - a).norm() < 0.4F ? kFirstRole : kNoRole) |
                                              ((p - b).norm() < 0.4F ? kSecondRole : kNoRole)));
  const float distance = (b - a).norm();
  PairCounts counts;
  const auto pairs =
      PairIndex(cloud.points, {})
          .find({.min_distance_m = distance - 0.1F, .max_distance_m = distance + 0.1F}, roles, kNoLimit, counts);
  ASSERT_TRUE(pairs);
  EXPECT_GT(pairs->size(), 100U);
  EXPECT_LT(counts.cell_tests + counts.distance_tests, 8 * pairs->size() + cloud.points.size());
}

}  // namespace
}  // namespace isthmus::congruent
