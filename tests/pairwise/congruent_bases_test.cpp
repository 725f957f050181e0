// The pair stage with bases of Super4PCS from the boundary of the grown overlap.
#include <gtest/gtest.h>

#include "pairwise/synthetic_product.h"
#include "pairwise/threads.h"
#include "store/archive.h"

namespace isthmus {
namespace {

TEST(BasesAtTheBoundary, LeaveTheAnswerRightAndTheSameForAnyNumberOfThreads) {
  const testing::PartialOverlap pair = testing::partial_overlap(1, {0, 0, 2.4});
  PairOptions options;
  options.congruent_bases = "boundary";
  const auto run = [&] {
    PairResult result = register_pair(pair.source, pair.target, options);
    result.seconds_by_stage.clear();
    return result;
  };
  const PairResult one = testing::with_threads(1, run), seven = testing::with_threads(7, run);
  ASSERT_TRUE(one.target_from_source);
  EXPECT_LT(testing::largest_displacement_m(pair.source, *one.target_from_source, pair.target_from_source),
            0.5 * testing::kHallVoxel);
  EXPECT_EQ(store::to_bytes(one), store::to_bytes(seven));
}

}  // namespace
}  // namespace isthmus
