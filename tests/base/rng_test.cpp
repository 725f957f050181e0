#include "base/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace isthmus {
namespace {

TEST(Rng, follows_the_published_sequence) {
  // SplitMix64 with seed 1234567: the first values of Vigna's reference implementation.
  Rng rng(1234567);
  EXPECT_EQ(rng.next(), 6457827717110365317ULL);
  EXPECT_EQ(rng.next(), 3203168211198807973ULL);
}

TEST(Rng, below_stays_below_and_reaches_all) {
  Rng rng(1);
  std::vector<int> seen(7, 0);
  for (int i = 0; i < 7000; ++i) ++seen.at(rng.below(7));
  for (const int count : seen) EXPECT_NEAR(count, 1000, 150);
}

TEST(Rng, uniform_and_normal_have_their_moments) {
  Rng rng(2);
  double sum = 0, sum_normal = 0, sq_normal = 0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform(-1, 3);
    ASSERT_GE(u, -1);
    ASSERT_LT(u, 3);
    sum += u;
    const double z = rng.normal();
    sum_normal += z;
    sq_normal += z * z;
  }
  EXPECT_NEAR(sum / n, 1.0, 0.02);
  EXPECT_NEAR(sum_normal / n, 0.0, 0.02);
  EXPECT_NEAR(sq_normal / n, 1.0, 0.03);
}

TEST(Rng, seeds_belong_to_items) {
  EXPECT_EQ(seed_of(7, "a.ply"), seed_of(7, "a.ply"));
  EXPECT_NE(seed_of(7, "a.ply"), seed_of(7, "b.ply"));
  EXPECT_NE(seed_of(7, "a.ply"), seed_of(8, "a.ply"));
}

}  // namespace
}  // namespace isthmus
