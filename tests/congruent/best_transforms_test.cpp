#include "congruent/best_transforms.h"

#include <gtest/gtest.h>

namespace isthmus::congruent {
namespace {

CountedTransform at(double x, std::int64_t common, int trial = 0) {
  CountedTransform t{Transform::Identity(), common, trial, {trial}};
  t.target_from_source.translation().x() = x;
  return t;
}

std::vector<std::int64_t> counts(const BestTransforms& best) {
  std::vector<std::int64_t> out;
  for (const auto& t : best.kept()) out.push_back(t.common);
  return out;
}

TEST(BestTransforms, KeepsTheBestFirst) {
  BestTransforms best(2, 0.1, 1, 0);
  EXPECT_TRUE(best.add(at(0, 5)));
  EXPECT_TRUE(best.add(at(1, 9)));
  EXPECT_EQ(best.to_beat(), 5);
  EXPECT_FALSE(best.add(at(2, 5))) << "an equal does not displace";
  EXPECT_TRUE(best.add(at(3, 7)));
  EXPECT_EQ(counts(best), (std::vector<std::int64_t>{9, 7}));
}

TEST(BestTransforms, OfTwinsOnlyTheBetterStays) {
  BestTransforms best(5, 0.1, 1, 0);
  best.add(at(0, 5));
  best.add(at(0.15, 6));
  EXPECT_FALSE(best.add(at(0.05, 6))) << "a twin of an equal";
  EXPECT_TRUE(best.add(at(0.08, 7))) << "displaces both";
  EXPECT_EQ(counts(best), (std::vector<std::int64_t>{7}));
}

TEST(BestTransforms, TheBetterTwinTakesOverTheVoters) {
  BestTransforms best(5, 0.1, 1, 0);
  best.add(at(0, 5, 1));
  best.add(at(0.05, 3, 1));
  best.add(at(0.05, 4, 2));
  EXPECT_EQ(best.kept().front().voters, (std::vector<int>{1, 2}));
  best.add(at(1, 4, 4));
  best.add(at(0.08, 7, 3));
  ASSERT_EQ(best.kept().size(), 2U);
  EXPECT_EQ(best.kept()[0].voters, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(best.kept()[1].voters, (std::vector<int>{4}));
}

TEST(BestTransforms, TurnsCountByTheSizeOfTheSource) {
  BestTransforms small(5, 0.1, 0.5, 0), large(5, 0.1, 5, 0);
  CountedTransform turned = at(0, 4);
  turned.target_from_source.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  small.add(at(0, 5)), large.add(at(0, 5));
  EXPECT_FALSE(small.add(turned));
  EXPECT_TRUE(large.add(turned));
}

TEST(BestTransforms, NeedsMoreThanTheFloor) {
  BestTransforms best(2, 0.1, 1, 3);
  EXPECT_FALSE(best.add(at(0, 3)));
  EXPECT_TRUE(best.add(at(0, 4)));
}

}  // namespace
}  // namespace isthmus::congruent
