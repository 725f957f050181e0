#include "base/parallel.h"

#include <gtest/gtest.h>

#include <vector>

namespace isthmus {
namespace {

TEST(ParallelForIndex, visits_every_index_once) {
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{1000}}) {
    std::vector<int> visits(n, 0);
    parallel_for_index(n, 16, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(n, 1));
  }
}

}  // namespace
}  // namespace isthmus
