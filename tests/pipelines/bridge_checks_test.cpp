#include "pipelines/bridge_checks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace isthmus::pipelines {
namespace {

/// Two triangles of scans, 0-1-2 and 3-4-5, each confirmed by its loop, and one link 3 -> 2 without a loop between
/// them. Stations 10 m apart along a line; each sees a 50 m x 10 m floor around it.
struct TwoParts {
  std::vector<ScanSummary> summaries{6};
  std::vector<OutlinedScan> scans;
  Solution solution;

  TwoParts() {
    for (int i = 0; i < 6; ++i) {
      ScanSummary& scan = summaries[static_cast<std::size_t>(i)];
      for (int x = -25; x <= 25; ++x)
        for (int y = -5; y <= 5; ++y) scan.outline.emplace_back(x, y, 0);
      scan.outline_cell_m = 1;
      PlacedScan placed;
      placed.id = i;
      placed.component_from_local.translation() = Eigen::Vector3d(10.0 * i, 0, 0);
      solution.scans.push_back(placed);
      scans.push_back({i, &scan, fmt::format("s{}", i)});
    }
    for (const auto& [s, t] :
         {std::pair{1, 0}, std::pair{2, 0}, std::pair{2, 1}, std::pair{4, 3}, std::pair{5, 3}, std::pair{5, 4}})
      add(s, t, true);
    add(3, 2, false);
  }
  void add(int source, int target, bool in_loop) {
    SolvedLink solved;
    solved.link.source = source;
    solved.link.target = target;
    solved.link.result.verdict = Verdict::accepted;
    solved.in_loop = in_loop;
    solution.links.push_back(solved);
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
  parts.add(1, 0, false), parts.add(2, 1, false), parts.add(3, 2, false);
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
  parts.add(4, 2, false);
  parts.solution.links.back().link.guided = true;
  std::vector<PosedPair> asked;
  const auto refuted = refuted_bridge(parts.solution, parts.scans, answering(asked, {kForbidden}));
  ASSERT_EQ(refuted.size(), 2U);
  EXPECT_EQ(refuted[0].source, 3);
  EXPECT_EQ(refuted[1].source, 4);
  EXPECT_NE(refuted[1].reason.find("found where s3 - s2 pointed"), std::string::npos);
}

TEST(BridgeChecks, LinksOnLoopsAreNotQuestioned) {
  TwoParts parts;
  for (SolvedLink& link : parts.solution.links) link.in_loop = true;
  std::vector<PosedPair> asked;
  EXPECT_TRUE(refuted_bridge(parts.solution, parts.scans, answering(asked, {kForbidden})).empty());
  EXPECT_TRUE(asked.empty());
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
