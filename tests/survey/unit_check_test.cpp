#include "survey/unit_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace isthmus {
namespace {

/// What each scan is suspected of, "-" for nothing.
std::vector<std::string> units(const std::vector<double>& extents) {
  std::vector<std::string> words;
  for (const auto& suspicion : suspect_units(extents)) {
    words.push_back(suspicion ? suspicion->unit + " among " + suspicion->survey_unit : "-");
  }
  return words;
}

using Words = std::vector<std::string>;

TEST(UnitCheck, names_a_scan_in_millimetres_among_metres) {
  EXPECT_EQ(units({24, 31, 24310, 18}), (Words{"-", "-", "millimetres among metres", "-"}));
  const auto suspicion = suspect_units(std::vector<double>{24, 31, 24310, 18})[2];
  ASSERT_TRUE(suspicion);
  EXPECT_EQ(suspicion->text(),
            "its extent is 24310, the median of the scans 24: it looks like millimetres among metres");
}

TEST(UnitCheck, names_centimetres_inches_and_metres_among_millimetres) {
  EXPECT_EQ(units({30, 40, 3500}), (Words{"-", "-", "centimetres among metres"}));
  EXPECT_EQ(units({30, 40, 1300}), (Words{"-", "-", "inches among metres"}));
  EXPECT_EQ(units({30000, 25, 40000}), (Words{"-", "metres among millimetres", "-"}));
}

TEST(UnitCheck, of_two_scans_the_larger_one_is_named) {
  EXPECT_EQ(units({20000, 25}), (Words{"millimetres among metres", "-"}));
  EXPECT_EQ(units({25, 20000}), (Words{"-", "millimetres among metres"}));
  EXPECT_EQ(units({0.15, 150}), (Words{"-", "millimetres among metres"})) << "small objects, too";
}

TEST(UnitCheck, is_silent_about_surveys_that_are_only_uneven) {
  const std::vector<std::vector<double>> surveys = {
      {},
      {25},
      {3, 30, 31, 29},               // a cupboard in a hall
      {3, 4, 3.5, 5, 120},           // rooms and one station outside
      {2, 2.5, 800, 750, 900},       // shafts and a valley
      {3, 12, 50, 220, 900, 3000},   // every size in between
      {24, 24 * 3.28, 25, 23},       // could be feet, could be a court
      {3000, 2500, 800, 4000},       // long-range scans
      {0.2, 0.25, 0.21, 4},          // a bunny and the table it stands on
      {20000, 22000, 31000, 18000},  // all in millimetres
  };
  for (const auto& extents : surveys) {
    for (const std::string& word : units(extents)) EXPECT_EQ(word, "-") << ::testing::PrintToString(extents);
  }
}

TEST(UnitCheck, does_not_depend_on_the_order) {
  std::vector<double> extents = {24, 31, 24310, 18, 29000, 22};
  const Words before = units(extents);
  std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5};
  std::mt19937 random(1);
  for (int trial = 0; trial < 10; ++trial) {
    std::ranges::shuffle(order, random);
    std::vector<double> shuffled;
    for (const std::size_t i : order) shuffled.push_back(extents[i]);
    const Words words = units(shuffled);
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(words[i], before[order[i]]);
  }
}

}  // namespace
}  // namespace isthmus
