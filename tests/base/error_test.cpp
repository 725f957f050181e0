#include "base/error.h"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(Error, reads_as_one_sentence) {
  EXPECT_EQ((Error{"too short", "a.ply:3", "copy it again"}).text(), "a.ply:3: too short (copy it again)");
  EXPECT_EQ((Error{"too short", "", ""}).text(), "too short");
}

TEST(Error, fail_makes_a_result) {
  const Result<int> result = fail("no", "here", "go there");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().hint, "go there");
}

}  // namespace
}  // namespace isthmus
