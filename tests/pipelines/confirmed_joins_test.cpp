#include "pipelines/confirmed_joins.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/line_of_stations.h"

namespace isthmus::pipelines {
namespace {

constexpr double kAccept = 0.97;
constexpr PoseCheck kForbidden{0.3, 0.12}, kFine{0.3, 0.01}, kSilent{0.01, 0.01};

/// Two triangles of scans, 0-1-2 and 3-4-5, as two parts, and the ambiguous link 3 -> 2 where it belongs, with a rival
/// that scores nearly as well a room off.
struct TwoParts : LineOfStations {
  explicit TwoParts(double probability = 0.3) : LineOfStations(6, 25) {
    for (const auto& [s, t] :
         {std::pair{1, 0}, std::pair{2, 0}, std::pair{2, 1}, std::pair{4, 3}, std::pair{5, 3}, std::pair{5, 4}})
      link(s, t, Verdict::accepted);
    split(3);
    for (ScanSummary& scan : summaries) scan.voxel_m = 0.2;
    Link& join = ambiguous(3, 2, probability);
    join.result.evidence = evidence(0.09, 0.085);
    join.result.rivals = {{Transform(Eigen::Translation3d(10.0 - kRoomM, 0, 0)), 0.085}};
  }
  static constexpr double kRoomM = 13;
  static std::vector<std::pair<std::string, double>> evidence(double score, double rival) {
    return {{"score", score},   {"near_score", 0},        {"rival_score", rival},
            {"support", score}, {"contradiction", 0.005}, {"observability", 0.4}};
  }
  [[nodiscard]] std::vector<ConfirmedLink> confirmed(const PoseChecker& check) const {
    return confirmed_joins(joins_of(*this), solution, scans, check, kAccept);
  }
};

/// Whether a pair stands as the line has it.
bool on_the_line(const PosedPair& p) {
  return std::abs(p.target_from_source.translation().x() - 10.0 * (p.source - p.target)) < 1e-6;
}

PoseChecker answering(PoseCheck on_line, PoseCheck off_line) {
  return [=](std::span<const PosedPair> pairs) {
    std::vector<std::optional<PoseCheck>> out;
    for (const PosedPair& p : pairs) out.emplace_back(on_the_line(p) ? on_line : off_line);
    return out;
  };
}

TEST(ConfirmedJoins, PartsThatMeetWhereOnlyTheRivalIsForbiddenConfirmTheLink) {
  const auto confirmed = TwoParts().confirmed(answering(kFine, kForbidden));
  ASSERT_EQ(confirmed.size(), 1u);
  EXPECT_EQ(confirmed[0].source, 3);
  EXPECT_EQ(confirmed[0].target, 2);
  EXPECT_GE(confirmed[0].probability, kAccept);
  EXPECT_NE(confirmed[0].reason.find("more pairs of scans"), std::string::npos) << confirmed[0].reason;
}

TEST(ConfirmedJoins, ARivalThatMayStandAsWellKeepsTheLinkOpen) {
  EXPECT_TRUE(TwoParts().confirmed(answering(kFine, kFine)).empty());
}

TEST(ConfirmedJoins, BelowALeastProbabilityNothingIsConfirmed) {
  EXPECT_TRUE(TwoParts(0.1).confirmed(answering(kFine, kForbidden)).empty());
}

TEST(ConfirmedJoins, OnePairInSeenThroughSpaceIsEnoughToKeepItOpen) {
  std::size_t asked = 0;
  const auto check = [&](std::span<const PosedPair> pairs) {
    std::vector<std::optional<PoseCheck>> out;
    for (const PosedPair& p : pairs) out.emplace_back(asked++ == 0 || !on_the_line(p) ? kForbidden : kFine);
    return out;
  };
  EXPECT_TRUE(TwoParts().confirmed(check).empty());
}

TEST(ConfirmedJoins, PairsThatSayNothingConfirmNothing) {
  EXPECT_TRUE(TwoParts(0.96).confirmed(answering(kSilent, kForbidden)).empty());
}

TEST(ConfirmedJoins, ALinkThatFreeSpaceForbidsByItselfIsNotConfirmed) {
  TwoParts parts;
  for (SolvedLink& l : parts.solution.links)
    if (l.measured == Verdict::ambiguous)
      l.link.result.evidence = {{"score", 0.3}, {"support", 0.3}, {"contradiction", 0.2}, {"observability", 0.4}};
  EXPECT_TRUE(parts.confirmed(answering(kFine, kForbidden)).empty());
}

TEST(ConfirmedJoins, TwoLinksThatDisagreeConfirmNeither) {
  TwoParts parts;
  parts.ambiguous(5, 0, 0.4, -30).result.evidence = TwoParts::evidence(0.09, 0);
  // Nothing speaks against the other place either.
  const auto check = [&](std::span<const PosedPair> pairs) {
    std::vector<std::optional<PoseCheck>> out;
    for (const PosedPair& p : pairs) {
      const double off = p.target_from_source.translation().x() - 10.0 * (p.source - p.target);
      out.emplace_back(std::abs(off + TwoParts::kRoomM) < 1e-6 ? kForbidden : kFine);
    }
    return out;
  };
  EXPECT_TRUE(parts.confirmed(check).empty());
}

TEST(ConfirmedJoins, OneLinkForEachTwoPartsTheMostProbable) {
  TwoParts parts;
  parts.ambiguous(4, 2, 0.6).result.evidence = TwoParts::evidence(0.12, 0.01);
  const auto confirmed = parts.confirmed(answering(kFine, kForbidden));
  ASSERT_EQ(confirmed.size(), 1u);
  EXPECT_EQ(confirmed[0].source, 4);
}

}  // namespace
}  // namespace isthmus::pipelines
