// The shape of the verdict, whatever its coefficients.
#include "pairwise/judge.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

PairEvidence good_evidence() {
  PairEvidence e;
  e.score = 0.3;
  e.rival_score = 0.01;
  e.support = 0.5;
  e.rare_support = 0.3;
  e.contradiction = 0.001;
  e.against = 0.01;
  e.rms_voxels = 0.1;
  e.observability = 0.5;
  e.num_supported = 4000;
  e.free_space = true;
  return e;
}

TEST(Probability, IsAProbabilityForAnyEvidence) {
  for (const double score : {-1.0, 0.0, 1e-9, 0.01, 1.0})
    for (const double rival : {0.0, 1e-9, 0.01, 1.0})
      for (const double contradiction : {0.0, 0.05, 1.0})
        for (const double supported : {0.0, 1.0, 1e6}) {
          PairEvidence e = good_evidence();
          e.score = score, e.rival_score = rival, e.contradiction = contradiction, e.num_supported = supported;
          e.support = supported > 0 ? 0.3 : 0;
          const double p = probability_of(e);
          EXPECT_TRUE(p >= 0 && p <= 1) << score << " " << rival << " " << contradiction << " " << supported << ": "
                                        << p;
        }
  const double nothing = probability_of({});
  EXPECT_LT(nothing, 0.5);
}

TEST(Verdict, ANeighbourAsGoodAlongAnUnobservedDirectionIsAmbiguous) {
  PairEvidence e = good_evidence();
  e.observability = 0.03;
  e.near_score = 0.95 * e.score;
  PairResult result;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_NE(result.reason.find("hardly fixed"), std::string::npos) << result.reason;
  for (const auto& [near_share, observability] : {std::pair(0.5, 0.03), std::pair(0.95, 0.5)}) {
    e.near_score = near_share * e.score, e.observability = observability;
    judge(e, PairOptions{}, result);
    EXPECT_EQ(result.verdict, Verdict::accepted) << result.reason;
  }
}

TEST(Verdict, ADirectionThatNothingFixesIsAmbiguousWithoutAnyNeighbour) {
  PairEvidence e = good_evidence();
  e.observability = 0.002;
  PairResult result;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_NE(result.reason.find("nothing fixes"), std::string::npos) << result.reason;
  e.observability = 0.02;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::accepted) << result.reason;
}

TEST(Verdict, MuchAgainstAPoseLeavesItToTheLoops) {
  PairEvidence e = good_evidence();
  e.support = 0.29, e.contradiction = 0.022;
  PairResult result;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_NE(result.reason.find("saw through"), std::string::npos) << result.reason;
  e.contradiction = 0.015;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::accepted) << result.reason;
}

TEST(Verdict, APoseThatAForbiddenOneGaveWayToIsNotAcceptedAndHasNoVote) {
  PairEvidence e = good_evidence();
  e.passed_over = 1.5 * e.score;
  PairResult result;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_LE(result.probability, 0.5);
  EXPECT_NE(result.reason.find("50 % more"), std::string::npos) << result.reason;
  EXPECT_TRUE(forbidden_by_free_space(result));
  EXPECT_LE(probability_against(result, 0), 0.5) << "the terms are all in the result";
}

TEST(FreeSpaceDiscount, TakesMostFromWhatSeenThroughSpaceForbids) {
  EXPECT_EQ(free_space_discount(0.6, 0), 1);
  EXPECT_EQ(free_space_discount(0.6, 0.005), 1);
  const double laid = free_space_discount(0.6, 0.02);
  EXPECT_GT(laid, 1);
  EXPECT_EQ(free_space_discount(0.05, 0.02), 1) << "what little is shared contradicts at its edges";
  EXPECT_EQ(free_space_discount(0.6, 0.06), kMostDiscount);
  EXPECT_GT(kMostDiscount, laid);
}

TEST(Verdict, ARivalIsNamedByWhereItLies) {
  PairEvidence e = good_evidence();
  e.rival_score = 0.9 * e.score, e.rival_voxels = 42, e.rival_deg = 91;
  PairResult result;
  judge(e, PairOptions{}, result);
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_NE(result.reason.find("42 voxels and 91 degrees"), std::string::npos) << result.reason;
}

TEST(Probability, GrowsWithTheScoreAndFallsWithTheRivalAndContradiction) {
  double last = 0;
  for (const double score : {0.005, 0.02, 0.05, 0.1, 0.2, 0.5}) {
    PairEvidence e = good_evidence();
    e.score = score;
    EXPECT_GE(probability_of(e), last);
    last = probability_of(e);
  }
  last = 1;
  for (const double rival : {0.0, 0.03, 0.1, 0.2, 0.3}) {
    PairEvidence e = good_evidence();
    e.rival_score = rival;
    EXPECT_LE(probability_of(e), last);
    last = probability_of(e);
  }
  last = 1;
  for (const double contradiction : {0.0, 0.01, 0.03, 0.1, 0.3}) {
    PairEvidence e = good_evidence();
    e.contradiction = contradiction;
    EXPECT_LE(probability_of(e), last);
    last = probability_of(e);
  }
}

// Rooms of one plan laid on each other: much support, and a few per cent of what both see against it.
TEST(Probability, TheSameShareContradictsMoreWhereTheScansSeeNearlyTheSame) {
  const auto odds = [](double support, double share) {
    PairEvidence e = good_evidence();
    e.score = 0.1, e.rival_score = 0.05;
    e.support = support, e.contradiction = support * share / (1 - share);
    const double p = probability_of(e);
    return std::log(p / (1 - p));
  };
  EXPECT_GT(odds(0.7, 0.003) - odds(0.7, 0.03), 2);
  EXPECT_LT(odds(0.1, 0.003) - odds(0.1, 0.03), 0.5) << "edges of what little is shared";
}

TEST(Probability, OfWhatWasWrittenDownIsTheSame) {
  for (const bool free_space : {false, true}) {
    PairEvidence e = good_evidence();
    e.free_space = free_space, e.contradiction = 0.01, e.near_score = 0.1;
    PairResult result;
    judge(e, {}, result);
    EXPECT_EQ(probability_against(result, e.rival_score), result.probability);
    EXPECT_LT(probability_against(result, e.score), result.probability);
  }
}

// Of a pair that is not sure by itself: what contradicts it, less the more the scans overlap.
TEST(FreeSpace, ForbidsLessOfAPairThatIsSureByItself) {
  const auto forbidden = [](double overlap, double share, double rival_score, double rare = 0.6) {
    PairEvidence e = good_evidence();
    e.rival_score = rival_score;
    e.support = 0.6 * overlap, e.rare_support = rare * e.support;
    e.contradiction = overlap * share / (1 - share);
    PairResult result;
    result.overlap = overlap;
    judge(e, {}, result);
    const bool found = forbidden_by_free_space(result);
    EXPECT_EQ(result.reason.find("saw through") != std::string::npos, found) << result.reason;
    return found;
  };
  constexpr double kClose = 0.25, kNone = 0.0;
  EXPECT_TRUE(forbidden(0.7, 0.02, kClose));
  EXPECT_FALSE(forbidden(0.7, 0.01, kClose));
  EXPECT_FALSE(forbidden(0.35, 0.03, kClose));
  EXPECT_TRUE(forbidden(0.35, 0.038, kClose));
  EXPECT_FALSE(forbidden(0.2, 0.035, kClose));
  EXPECT_TRUE(forbidden(0.2, 0.045, kClose));
  EXPECT_FALSE(forbidden(0.08, 0.2, kClose)) << "the edges of what little is shared";
  EXPECT_FALSE(forbidden(0.5, 0.03, kNone)) << "sure by itself";
  EXPECT_TRUE(forbidden(0.5, 0.03, kNone, 0.3)) << "sure, but of what is everywhere";
  EXPECT_TRUE(forbidden(0.7, 0.1, kNone)) << "too much for any pair";
}

TEST(Probability, AnEqualRivalIsNeverTrusted) {
  PairEvidence e = good_evidence();
  e.rival_score = e.score;
  PairResult result;
  judge(e, {}, result);
  EXPECT_NE(result.verdict, Verdict::accepted);
  EXPECT_FALSE(result.reason.empty());
}

TEST(Judge, TheVerdictIsTheProbabilityCutAtTheOptions) {
  const double p = probability_of(good_evidence());
  PairOptions options;
  const auto verdict = [&](double accept, double ambiguous) {
    options.accept_probability = accept, options.ambiguous_probability = ambiguous;
    PairResult result;
    judge(good_evidence(), options, result);
    EXPECT_EQ(result.probability, p);
    EXPECT_FALSE(result.reason.empty());
    EXPECT_NE(result.reason, "not computed");
    return result.verdict;
  };
  EXPECT_EQ(verdict(p, 0), Verdict::accepted) << "at the limit";
  EXPECT_EQ(verdict(p + 1e-6, 0), Verdict::ambiguous);
  EXPECT_EQ(verdict(1.1, p), Verdict::ambiguous);
  EXPECT_EQ(verdict(1.1, p + 1e-6), Verdict::rejected);
}

TEST(Judge, TheEvidenceIsNamedInAFixedOrder) {
  PairResult a, b;
  judge(good_evidence(), {}, a);
  judge({}, {}, b);
  ASSERT_EQ(a.evidence.size(), b.evidence.size());
  for (std::size_t k = 0; k < a.evidence.size(); ++k) EXPECT_EQ(a.evidence[k].first, b.evidence[k].first);
  const auto term = [&](const std::string& name) {
    for (const auto& [key, value] : a.evidence)
      if (key == name) return value;
    ADD_FAILURE() << "no term " << name;
    return 0.0;
  };
  EXPECT_EQ(term("score"), 0.3);
  EXPECT_EQ(term("rival_score"), 0.01);
  EXPECT_EQ(term("contradiction"), 0.001);
  EXPECT_EQ(term("free_space"), 1);
}

TEST(Judge, TheReasonNamesWhatSpokeAgainstThePose) {
  PairOptions never;
  never.accept_probability = 1.1;
  PairResult rival, free_space;
  PairEvidence e = good_evidence();
  e.rival_score = 0.99 * e.score;
  judge(e, never, rival);
  EXPECT_NE(rival.reason.find("rival"), std::string::npos) << rival.reason;
  e = good_evidence();
  e.contradiction = 0.3;
  judge(e, never, free_space);
  EXPECT_NE(free_space.reason.find("saw through"), std::string::npos) << free_space.reason;
}

TEST(Verdict, WordsOfTheOutputs) {
  EXPECT_STREQ(to_string(Verdict::accepted), "accepted");
  EXPECT_STREQ(to_string(Verdict::ambiguous), "ambiguous");
  EXPECT_STREQ(to_string(Verdict::rejected), "rejected");
  EXPECT_STREQ(to_string(Verdict::failed), "failed");
}

}  // namespace
}  // namespace isthmus
