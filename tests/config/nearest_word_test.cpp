#include "config/nearest_word.h"

#include <gtest/gtest.h>

#include <vector>

namespace isthmus::config {
namespace {

TEST(EditDistance, counts_single_edits) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("voxel", "vxoel"), 1U);  // two neighbours swapped
  EXPECT_EQ(edit_distance("Voxel", "voxel"), 0U);
}

TEST(NearestWord, finds_the_misspelt_one_and_is_silent_when_nothing_is_near) {
  const std::vector<std::string> words = {"voxel_m", "radius", "trials"};
  EXPECT_EQ(nearest_word("voxl_m", words), "voxel_m");
  EXPECT_EQ(nearest_word("trails", words), "trials");
  EXPECT_EQ(nearest_word("completely_else", words), "");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace isthmus::config
