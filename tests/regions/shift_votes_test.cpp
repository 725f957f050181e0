// Votes for the shift between two ground plans, and how many peaks each turn may keep.
#include "regions/shift_votes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "regions/random_plan.h"

namespace isthmus {
namespace {

constexpr float kCell = 0.6f;

using testing::moved;

GroundPlan plan_of(std::size_t columns, std::uint64_t seed) { return testing::random_plan(columns, 20, seed); }

TEST(ShiftVotes, TheHeaviestPeakIsTheShiftUnderItsTurn) {
  const GroundPlan source = plan_of(80, 1), target = moved(source, 0.7f, {5.0f, -3.0f});
  const ShiftVotes votes(source, target, kCell);
  const auto peaks = heaviest_shifts(votes, {0.7f}, 24, 100);
  ASSERT_FALSE(peaks.empty());
  EXPECT_LT((peaks.front().shift - Eigen::Vector2f(5, -3)).norm(), kCell);
  EXPECT_GT(peaks.front().votes, 2 * peaks.back().votes);
  for (std::size_t k = 1; k < peaks.size(); ++k) EXPECT_GE(peaks[k - 1].votes, peaks[k].votes);
}

TEST(ShiftVotes, EachTurnKeepsItsShareAndAllTogetherWhatIsAskedFor) {
  const GroundPlan source = plan_of(120, 2), target = plan_of(120, 3);
  const ShiftVotes votes(source, target, kCell);
  const std::vector<float> turns{-2.0f, -1.0f, 0.0f, 1.0f, 2.0f};
  std::map<float, int> of_turn;
  for (const PlanPose& p : heaviest_shifts(votes, turns, 7, 1000)) ++of_turn[p.yaw];
  ASSERT_EQ(of_turn.size(), turns.size());
  for (const auto& [yaw, count] : of_turn) EXPECT_EQ(count, 7) << yaw;

  const auto all = heaviest_shifts(votes, turns, 7, 1000), few = heaviest_shifts(votes, turns, 7, 12);
  ASSERT_EQ(few.size(), 12u);
  for (std::size_t k = 0; k < few.size(); ++k) EXPECT_EQ(few[k].votes, all[k].votes) << "the heaviest stay";
}

// More turns than are counted in one grid: what a turn leaves behind must not show in the next.
TEST(ShiftVotes, ATurnFindsTheSameWhateverWasCountedBefore) {
  const GroundPlan source = plan_of(90, 4), target = plan_of(100, 5);
  const ShiftVotes votes(source, target, kCell);
  std::vector<float> turns;
  for (int k = 0; k < 30; ++k) turns.push_back(-3.0f + 0.2f * static_cast<float>(k));
  std::vector<PlanPose> alone;
  for (const float yaw : turns) {
    const auto peaks = heaviest_shifts(votes, {yaw}, 10, 10);
    alone.insert(alone.end(), peaks.begin(), peaks.end());
  }
  std::ranges::stable_sort(alone, std::ranges::greater(), &PlanPose::votes);
  const auto together = heaviest_shifts(votes, turns, 10, 1000);
  ASSERT_EQ(together.size(), alone.size());
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_EQ(together[k].yaw, alone[k].yaw);
    EXPECT_EQ(together[k].shift, alone[k].shift);
    EXPECT_EQ(together[k].votes, alone[k].votes);
  }
}

}  // namespace
}  // namespace isthmus
