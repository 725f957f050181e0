// Ground plans of one place are alike, whatever their turn, shift and share; those of others are not.
#include "regions/plan_likeness.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "regions/random_plan.h"

namespace isthmus {
namespace {

using testing::moved;
using testing::random_plan;
using testing::seen_within;

TEST(PlanLikeness, ASharedPartTellsWhateverTheTurnAndTheShift) {
  const GroundPlan place = random_plan(600, 40, 1);
  const GroundPlan left = seen_within(place, {-12, 0}, 24), right = seen_within(place, {12, 0}, 24);
  const float alike = plan_likeness(left, right);
  float most_elsewhere = 0;
  for (std::uint64_t seed = 2; seed < 12; ++seed)
    most_elsewhere =
        std::max(most_elsewhere, plan_likeness(left, seen_within(random_plan(600, 40, seed), {12, 0}, 24)));
  EXPECT_GT(alike, 3 * most_elsewhere);
  EXPECT_NEAR(plan_likeness(left, moved(right, 2.1f, {2, -1}, 5)), alike, 0.35f * alike);
  EXPECT_NEAR(plan_likeness(right, left), alike, 0.35f * alike);
}

TEST(PlanLikeness, WhatRepeatsTellsLittle) {
  GroundPlan row;
  row.cell_m = 0.6f;
  for (int room = 0; room < 12; ++room)
    for (const Column& c : random_plan(30, 2.5, 4).columns) {
      Column copy = c;
      copy.p.x() += 6.0f * static_cast<float>(room);
      row.columns.push_back(copy);
    }
  const GroundPlan repeated = seen_within(row, {33, 0}, 1e6f);
  const GroundPlan once = random_plan(repeated.columns.size(), 40, 4);
  EXPECT_LT(plan_likeness(repeated, repeated), 0.4f * plan_likeness(once, once));
}

TEST(PlanLikeness, HeightsAreAsked) {
  const GroundPlan place = random_plan(300, 30, 1);
  GroundPlan other_heights = place;
  Rng rng(9);
  for (Column& c : other_heights.columns) {
    c.bottom = static_cast<float>(rng.uniform(-10, 10));
    c.top = c.bottom + static_cast<float>(rng.uniform(1, 10));
  }
  EXPECT_LT(plan_likeness(place, other_heights), 0.5f * plan_likeness(place, place));
}

TEST(PlanLikeness, TheOtherEndUpIsAnotherPlan) {
  const GroundPlan place = random_plan(300, 30, 1), hanging = upside_down(place);
  EXPECT_LT(plan_likeness(place, hanging), 0.5f * plan_likeness(place, place));
  EXPECT_FLOAT_EQ(plan_likeness(place, upside_down(hanging)), plan_likeness(place, place));
}

TEST(PlanLikeness, TooFewColumnsSayNothing) {
  const GroundPlan few = random_plan(7, 10, 1), many = random_plan(300, 30, 1);
  EXPECT_EQ(plan_likeness(few, many), 0);
  EXPECT_EQ(plan_likeness(many, few), 0);
  EXPECT_EQ(plan_likeness({}, {}), 0);
}

TEST(PlanLikeness, ATowerFarAwayCostsNoMemory) {
  const GroundPlan place = random_plan(300, 30, 1);
  GroundPlan with_tower = place;
  with_tower.columns.push_back(place.columns.front());
  with_tower.columns.back().p = {60000.0f, -80000.0f};
  with_tower = testing::with_radius(with_tower);
  EXPECT_GT(plan_likeness(with_tower, with_tower), 0.2f * plan_likeness(place, place));
}

TEST(PlanLikeness, DoesNotDependOnThreads) {
  const GroundPlan place = random_plan(600, 40, 1);
  const GroundPlan left = seen_within(place, {-12, 0}, 24), right = seen_within(place, {12, 0}, 24);
  float alone = 0;
  tbb::task_arena(1).execute([&] { alone = plan_likeness(left, right); });
  EXPECT_EQ(plan_likeness(left, right), alone);
}

}  // namespace
}  // namespace isthmus
