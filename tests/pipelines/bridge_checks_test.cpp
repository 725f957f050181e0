#include "pipelines/bridge_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "pipelines/line_of_stations.h"
#include "pipelines/survey_pipeline.h"

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

/// The pairs of `forbidden`, whichever way round, are; all others are fine.
PoseChecker forbidding(std::set<std::pair<int, int>> forbidden) {
  return [forbidden = std::move(forbidden)](std::span<const PosedPair> pairs) {
    std::vector<std::optional<PoseCheck>> out;
    for (const PosedPair& p : pairs)
      out.emplace_back(forbidden.contains(std::minmax(p.source, p.target)) ? kForbidden : kFine);
    return out;
  };
}

std::set<std::pair<int, int>> links_of(const std::vector<RefutedLink>& refuted) {
  std::set<std::pair<int, int>> out;
  for (const RefutedLink& link : refuted) out.insert(std::minmax(link.source, link.target));
  return out;
}

TEST(BridgeChecks, TwoPartsThatTwoLinksSpanAreNotTakenApartByAFewPairsAcross) {
  TwoParts parts;
  parts.link(4, 1, Verdict::accepted);
  EXPECT_TRUE(refuted_bridge(parts.solution, parts.scans, forbidding({{0, 3}})).empty());
}

// 0 - 1 - 2 in a triangle, and 3 on two links that agree: a room that equals the right one explains both.
TEST(BridgeChecks, AScanThatHangsInTheWrongPlaceByTwoLinksIsTakenOut) {
  LineOfStations line(5, 35);
  for (const auto& [s, t] : {std::pair{1, 0}, std::pair{2, 0}, std::pair{2, 1}, std::pair{4, 1}, std::pair{4, 0},
                             std::pair{3, 2}, std::pair{3, 1}})
    line.link(s, t, Verdict::accepted);
  EXPECT_TRUE(refuted_bridge(line.solution, line.scans, forbidding({})).empty());
  const auto refuted = refuted_bridge(line.solution, line.scans, forbidding({{0, 3}, {3, 4}}));
  EXPECT_EQ(links_of(refuted), (std::set<std::pair<int, int>>{{1, 3}, {2, 3}}));
}

/// 0-1-2 and 4-5-6, and scan 3 on two links to either: a cut scan.
struct CutScan : LineOfStations {
  explicit CutScan(double probability_of_second) : LineOfStations(7, 35) {
    for (const auto& [s, t] :
         {std::pair{1, 0}, std::pair{2, 0}, std::pair{2, 1}, std::pair{5, 4}, std::pair{6, 4}, std::pair{6, 5}})
      link(s, t, Verdict::accepted);
    for (const auto& [s, t] : {std::pair{3, 2}, std::pair{3, 1}})
      link(s, t, Verdict::accepted).result.probability = 0.99;
    for (const auto& [s, t] : {std::pair{4, 3}, std::pair{5, 3}})
      link(s, t, Verdict::accepted).result.probability = probability_of_second;
  }
};
const std::set<std::pair<int, int>> kAllAcross = {{0, 4}, {1, 4}, {2, 4}, {0, 5}, {1, 5},
                                                  {2, 5}, {0, 6}, {1, 6}, {2, 6}};

TEST(BridgeChecks, OfTwoBranchesThatForbidEachOtherTheLikelierHoldsTheScanBetween) {
  const CutScan survey(0.9999);
  const auto refuted = refuted_bridge(survey.solution, survey.scans, forbidding(kAllAcross));
  EXPECT_EQ(links_of(refuted), (std::set<std::pair<int, int>>{{1, 3}, {2, 3}}));
}

TEST(BridgeChecks, WhereNobodyKnowsWhichBranchIsWrongTheScanStaysInNeither) {
  const CutScan survey(0.995);
  const auto refuted = refuted_bridge(survey.solution, survey.scans, forbidding(kAllAcross));
  EXPECT_EQ(links_of(refuted), (std::set<std::pair<int, int>>{{1, 3}, {2, 3}, {3, 4}, {3, 5}}));
  EXPECT_NE(refuted[0].reason.find(", or with s"), std::string::npos) << refuted[0].reason;
}

// The pairs of the scan itself decide where the links' own words do not.
TEST(BridgeChecks, ThePairsOfTheScanBetweenSayWhichBranchIsWrong) {
  const CutScan survey(0.99);
  auto forbidden = kAllAcross;
  forbidden.insert({3, 6});
  const auto refuted = refuted_bridge(survey.solution, survey.scans, forbidding(forbidden));
  EXPECT_EQ(links_of(refuted), (std::set<std::pair<int, int>>{{3, 4}, {3, 5}}));
}

/// Two parts, and a link between them that was accepted by itself and refuted since.
struct RefutedBetween : SplitParts {
  RefutedBetween() {
    solution.links.pop_back();
    solution.links.back().measured = Verdict::accepted;
    solution.links.back().link.refuted = "for a reason that is gone";
    solution.links.back().link.result.verdict = Verdict::rejected;
  }
};

TEST(Acquittal, ARefutedLinkComesBackWhereTheScansAroundItMeetAndNoneIsForbidden) {
  const RefutedBetween parts;
  const auto joins = refuted_between_parts(parts.solution, summaries_of(parts.scans));
  ASSERT_EQ(joins.size(), 1U);
  std::vector<PosedPair> asked;
  const auto back = acquitted_links(joins, answering(asked, {kFine}));
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0], std::pair(3, 2));
  EXPECT_FALSE(asked.empty());
  EXPECT_TRUE(acquitted_links(joins, answering(asked, {kFine, kFine, kForbidden})).empty());
  EXPECT_TRUE(acquitted_links(joins, answering(asked, {PoseCheck{0.02, 0}})).empty()) << "nobody speaks for it";
}

TEST(Acquittal, OnlyLinksBetweenPartsThatWereAcceptedByThemselvesAppeal) {
  RefutedBetween parts;
  parts.solution.links.back().measured = Verdict::ambiguous;
  EXPECT_TRUE(refuted_between_parts(parts.solution, summaries_of(parts.scans)).empty());
  parts.solution.links.back().measured = Verdict::accepted;
  EXPECT_EQ(refuted_between_parts(parts.solution, summaries_of(parts.scans)).size(), 1U);
  parts.solution.links.back().link.guided = true;
  EXPECT_TRUE(refuted_between_parts(parts.solution, summaries_of(parts.scans)).empty()) << "told where to look";
  parts.solution.links.back().link.guided = false;
  parts.solution.links.back().link.refuted.clear();
  EXPECT_TRUE(refuted_between_parts(parts.solution, summaries_of(parts.scans)).empty()) << "rejected, not refuted";
}

TEST(Acquittal, OnlyTheFirstCounts) {
  PairOutcome pair;
  EXPECT_TRUE(pair.refute("a"));
  EXPECT_TRUE(pair.acquit());
  EXPECT_TRUE(pair.refuted.empty());
  EXPECT_TRUE(pair.refute("b"));
  EXPECT_FALSE(pair.acquit());
  EXPECT_EQ(pair.refuted, "b");
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
