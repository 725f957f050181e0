#include "pipelines/bridge_checks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/line_of_stations.h"

namespace isthmus::pipelines {
namespace {

/// Two triangles of scans, 0-1-2 and 3-4-5, each confirmed by its loop, and one link 3 -> 2 without a loop between
/// them.
struct TwoParts : LineOfStations {
  TwoParts() : LineOfStations(6, 25) {
    for (const auto& [s, t] :
         {std::pair{1, 0}, std::pair{2, 0}, std::pair{2, 1}, std::pair{4, 3}, std::pair{5, 3}, std::pair{5, 4}})
      link(s, t, Verdict::accepted);
    link(3, 2, Verdict::accepted);
  }
};

constexpr PoseCheck kForbidden{0.3, 0.12}, kFine{0.3, 0.01};

PoseChecker answering(std::vector<PosedPair>& asked, const std::vector<PoseCheck>& cycle) {
  return [&asked, cycle](std::span<const PosedPair> pairs) {
    asked.assign(pairs.begin(), pairs.end());
    std::vector<std::optional<PoseCheck>> out;
    for (std::size_t k = 0; k < pairs.size(); ++k) out.emplace_back(cycle[k % cycle.size()]);
    return out;
  };
}

TEST(BridgeChecks, PairsAcrossALinkWithoutALoopAreAskedAndRefuteIt) {
  const TwoParts parts;
  std::vector<PosedPair> asked;
  const auto refuted = refuted_bridge(parts.solution, parts.scans, answering(asked, {kForbidden, kFine}));
  ASSERT_FALSE(asked.empty());
  EXPECT_LE(asked.size(), 12U);
  for (const PosedPair& pair : asked) {
    EXPECT_GE(pair.source, 3);
    EXPECT_LE(pair.target, 2);
    EXPECT_FALSE(pair.source == 3 && pair.target == 2) << "the link has had its say";
    EXPECT_NEAR(pair.target_from_source.translation().x(), 10.0 * (pair.source - pair.target), 1e-9);
  }
  ASSERT_EQ(refuted.size(), 1U);
  EXPECT_EQ(refuted[0].source, 3);
  EXPECT_EQ(refuted[0].target, 2);
  EXPECT_NE(refuted[0].reason.find("12 %"), std::string::npos) << refuted[0].reason;
}

/// The same triangles as two components, with ambiguous links between them: 3 -> 2 right, 5 -> 0 a room off.
struct SplitParts : LineOfStations {
  SplitParts() : LineOfStations(6, 25) {
    for (const auto& [s, t] :
         {std::pair{1, 0}, std::pair{2, 0}, std::pair{2, 1}, std::pair{4, 3}, std::pair{5, 3}, std::pair{5, 4}})
      link(s, t, Verdict::accepted);
    split(3);
    ambiguous(3, 2, 0.4);
    ambiguous(5, 0, 0.6, -30);
  }
};

/// Whether a pair stands as the line has it.
bool on_the_line(const PosedPair& p) {
  return std::abs(p.target_from_source.translation().x() - 10.0 * (p.source - p.target)) < 1e-6;
}

TEST(JoinChecks, APartLaidWhereItCannotStandRefutesTheLinkThatLaidItThere) {
  const SplitParts parts;
  std::size_t num_asked = 0;
  const auto check = [&](std::span<const PosedPair> pairs) {
    std::vector<std::optional<PoseCheck>> out;
    for (const PosedPair& p : pairs) {
      EXPECT_TRUE(p.source >= 3 && p.target < 3) << "only pairs across";
      out.emplace_back(on_the_line(p) ? kFine : kForbidden);
    }
    num_asked = pairs.size();
    return out;
  };
  const auto refuted = refuted_joins(joins_of(parts), parts.scans, check);
  EXPECT_GT(num_asked, 4U);
  ASSERT_EQ(refuted.size(), 1U);
  EXPECT_EQ(refuted[0].source, 5);
  EXPECT_EQ(refuted[0].target, 0);
  EXPECT_NE(refuted[0].reason.find("saw through"), std::string::npos) << refuted[0].reason;
}

TEST(JoinChecks, ALinkThatFreeSpaceForbidsByItselfIsNotAsked) {
  SplitParts parts;
  for (SolvedLink& l : parts.solution.links) l.link.result.evidence = {{"support", 0.3}, {"contradiction", 0.2}};
  const auto check = [](std::span<const PosedPair>) -> std::vector<std::optional<PoseCheck>> {
    ADD_FAILURE() << "it has no vote, so there is nothing to refute";
    return {};
  };
  EXPECT_TRUE(refuted_joins(joins_of(parts), parts.scans, check).empty());
}

TEST(BridgeChecks, FewDoubtfulWitnessesRefuteNothing) {
  const TwoParts parts;
  std::vector<PosedPair> asked;
  EXPECT_TRUE(refuted_bridge(parts.solution, parts.scans, answering(asked, {kFine})).empty());
  EXPECT_TRUE(refuted_bridge(parts.solution, parts.scans,
                             answering(asked, {kFine, kFine, kFine, kFine, kFine, kFine, kFine, kForbidden}))
                  .empty());
}

// 0 - 1 - 2 - 3, a chain: the pairs that cross 2 - 1 are forbidden, those that cross only another link are not.
TEST(BridgeChecks, TheLinkThatAllForbiddenPairsCrossIsAccused) {
  TwoParts parts;
  parts.solution.links.clear();
  parts.link(1, 0, Verdict::accepted), parts.link(2, 1, Verdict::accepted), parts.link(3, 2, Verdict::accepted);
  const auto check = [](std::span<const PosedPair> pairs) {
    std::vector<std::optional<PoseCheck>> out;
    for (const PosedPair& pair : pairs) out.emplace_back(pair.target <= 1 && pair.source >= 2 ? kForbidden : kFine);
    return out;
  };
  const auto refuted = refuted_bridge(parts.solution, parts.scans, check);
  ASSERT_EQ(refuted.size(), 1U);
  EXPECT_EQ(refuted[0].source, 2);
  EXPECT_EQ(refuted[0].target, 1);
}

TEST(BridgeChecks, WhatWasFoundWhereTheWrongLinkPointedGoesWithIt) {
  TwoParts parts;
  parts.link(4, 2, Verdict::accepted).guided = true;
  std::vector<PosedPair> asked;
  const auto refuted = refuted_bridge(parts.solution, parts.scans, answering(asked, {kForbidden}));
  ASSERT_EQ(refuted.size(), 2U);
  EXPECT_EQ(refuted[0].source, 3);
  EXPECT_EQ(refuted[1].source, 4);
  EXPECT_NE(refuted[1].reason.find("believed where s3 - s2 pointed"), std::string::npos);
}

TEST(BridgeChecks, LinksThatAnotherSpansAreNotQuestioned) {
  TwoParts parts;
  parts.link(4, 1, Verdict::accepted);
  std::vector<PosedPair> asked;
  EXPECT_TRUE(refuted_bridge(parts.solution, parts.scans, answering(asked, {kForbidden})).empty());
  EXPECT_TRUE(asked.empty());
}

// Where rooms repeat, an ambiguous link agrees with the wrong one: their loop proves nothing.
TEST(BridgeChecks, ALoopThatClosesOnlyThroughAPromotedLinkIsQuestionedAndGoesAsAWhole) {
  TwoParts parts;
  parts.link(4, 1, Verdict::accepted);
  parts.solution.links.back().measured = Verdict::ambiguous;
  std::vector<PosedPair> asked;
  const auto refuted = refuted_bridge(parts.solution, parts.scans, answering(asked, {kForbidden}));
  ASSERT_EQ(refuted.size(), 2U);
  EXPECT_EQ(std::pair(refuted[0].source, refuted[0].target), std::pair(3, 2));
  EXPECT_EQ(std::pair(refuted[1].source, refuted[1].target), std::pair(4, 1));
}

TEST(BridgeChecks, PairsThatCannotBeCheckedSayNothing) {
  const TwoParts parts;
  const auto unknown = [](std::span<const PosedPair> pairs) {
    return std::vector<std::optional<PoseCheck>>(pairs.size());
  };
  EXPECT_TRUE(refuted_bridge(parts.solution, parts.scans, unknown).empty());
}

TEST(PoseCheck, NeedsBothMuchAndALargeShareToForbid) {
  EXPECT_TRUE((PoseCheck{0.3, 0.06}).forbidden());
  EXPECT_FALSE((PoseCheck{0.3, 0.04}).forbidden());
  EXPECT_FALSE((PoseCheck{0.7, 0.06}).forbidden());
  EXPECT_FALSE((PoseCheck{}).forbidden());
}

}  // namespace
}  // namespace isthmus::pipelines
