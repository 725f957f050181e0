#include "regions/matching.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/rng.h"
#include "pairwise/threads.h"

namespace isthmus {
namespace {

// Small whole numbers: products and sums are exact in any order, so ties are ties.
FeatureCloud whole_number_cloud(std::uint32_t n, std::uint32_t dimension, std::uint64_t seed) {
  Rng rng(seed);
  FeatureCloud cloud;
  cloud.dimension = dimension;
  for (std::uint32_t k = 0; k < n; ++k) {
    cloud.keypoints.push_back(k);
    for (std::uint32_t b = 0; b < dimension; ++b) cloud.descriptors.push_back(static_cast<float>(rng.below(4)));
  }
  return cloud;
}

float product(const FeatureCloud& a, std::uint32_t i, const FeatureCloud& b, std::uint32_t j) {
  float sum = 0;
  for (std::uint32_t k = 0; k < a.dimension; ++k)
    sum += a.descriptors[i * a.dimension + k] * b.descriptors[j * b.dimension + k];
  return sum;
}

void expect_brute_force(const FeatureCloud& source, const FeatureCloud& target, std::uint32_t count) {
  const MatchTable table = match_descriptors(source, target, count);
  const auto m = static_cast<std::uint32_t>(target.keypoints.size());
  ASSERT_EQ(table.count, std::min(count, m));
  ASSERT_EQ(table.target.size(), source.keypoints.size() * table.count);
  ASSERT_EQ(table.similarity.size(), table.target.size());
  for (std::uint32_t i = 0; i < source.keypoints.size(); ++i) {
    std::vector<std::uint32_t> order(m);
    for (std::uint32_t j = 0; j < m; ++j) order[j] = j;
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return product(source, i, target, a) > product(source, i, target, b);
    });
    for (std::uint32_t r = 0; r < table.count; ++r) {
      ASSERT_EQ(table.target[i * table.count + r], order[r]) << "keypoint " << i << ", rank " << r;
      EXPECT_EQ(table.similarity[i * table.count + r], product(source, i, target, order[r]));
    }
  }
}

TEST(Matching, IsBruteForceAndTiesGoToTheSmallerIndex) {
  expect_brute_force(whole_number_cloud(150, 6, 1), whole_number_cloud(211, 6, 2), 10);  // many ties
  expect_brute_force(whole_number_cloud(65, 66, 3), whole_number_cloud(64, 66, 4), 1);
  expect_brute_force(whole_number_cloud(1, 3, 5), whole_number_cloud(1, 3, 6), 1);
}

TEST(Matching, AsksForNoMoreThanThereAre) {
  expect_brute_force(whole_number_cloud(20, 5, 7), whole_number_cloud(4, 5, 8), 48);
  const FeatureCloud none = whole_number_cloud(0, 5, 9), some = whole_number_cloud(7, 5, 9);
  EXPECT_TRUE(match_descriptors(none, some, 3).target.empty());
  EXPECT_TRUE(match_descriptors(some, none, 3).target.empty());
  EXPECT_EQ(match_descriptors(some, none, 3).count, 0u);
  EXPECT_TRUE(match_descriptors(some, some, 0).target.empty());
}

TEST(Matching, TheSameForAnyNumberOfThreads) {
  FeatureCloud a = whole_number_cloud(300, 66, 10), b = whole_number_cloud(400, 66, 11);
  Rng rng(12);
  for (float& v : a.descriptors) v += static_cast<float>(rng.uniform());
  for (float& v : b.descriptors) v += static_cast<float>(rng.uniform());
  const auto one = testing::with_threads(1, [&] { return match_descriptors(a, b, 20); });
  const auto seven = testing::with_threads(7, [&] { return match_descriptors(a, b, 20); });
  EXPECT_EQ(one.target, seven.target);
  EXPECT_EQ(one.similarity, seven.similarity);
}

}  // namespace
}  // namespace isthmus
