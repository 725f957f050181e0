#include "pairwise/judge.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace isthmus {

namespace {

// Share of what lies in sight of the other station that contradicts the pose.
double share_of(double contradiction, double support) {
  return contradiction / std::max(contradiction + support, 1e-9);
}
double contradicting_share(const PairEvidence& e) { return share_of(e.contradiction, e.support); }

// Where so much of a scan stands in space that the other station saw through, no support is enough: repeated halls and
// rooms of the same size reach 4-9 % at 60 % support, true poses of whole scans stay below 3 %.
bool vetoed(double contradiction, double support) {
  constexpr double kMaxContradiction = 0.03, kMaxShare = 0.05;
  return contradiction > kMaxContradiction && share_of(contradiction, support) > kMaxShare;
}
bool vetoed(const PairEvidence& e) { return vetoed(e.contradiction, e.support); }

// Corridors and rooms of one plan laid on each other: two thirds of both are explained and 2 to 4 % contradicted. Of
// 153 right poses above 40 % overlap ten are beyond this limit, eight of them sure by themselves; of 148 wrong ones
// 144.
bool laid_on_its_equal(double contradiction, double overlap) {
  constexpr double kLeastOverlap = 0.1, kLittle = 0.3, kMuch = 0.5, kLimitOfLittle = 0.04, kLimitOfMuch = 0.015;
  if (overlap < kLeastOverlap) return false;
  const double much = std::clamp((overlap - kLittle) / (kMuch - kLittle), 0.0, 1.0);
  return share_of(contradiction, overlap) > std::lerp(kLimitOfLittle, kLimitOfMuch, much);
}

// Where one direction is hardly observed and a neighbouring pose explains nearly as much, the pair slides: right
// perhaps, but not to two voxels.
bool slides(const PairEvidence& e) {
  constexpr double kAsGood = 0.85, kHardlyObserved = 0.07;
  return e.near_score > kAsGood * e.score && e.observability < kHardlyObserved;
}

// A room laid into the next one of its size and furniture: no rival, 29 % support, and 7 % of what is in sight against
// it. Of 262 right accepted pairs two show as much; loops can still confirm such a pair.
constexpr double kDoubtfulProbability = 0.95;
bool doubtful(const PairEvidence& e) {
  constexpr double kDoubtful = 0.018, kDoubtfulShare = 0.065;
  return e.contradiction > kDoubtful && contradicting_share(e) > kDoubtfulShare;
}

// Where one direction is not observed at all (one plane, parallel walls, a piece of floor) no share explained tells
// where along it the pair belongs, whatever the other hypotheses are. Of 612 right poses 16 have less than 0.02, two
// less than 0.01.
bool unobserved(const PairEvidence& e) {
  constexpr double kNotObserved = 0.01;
  return e.observability < kNotObserved;
}

// The terms that the probability is made of, as judge() wrote them down.
PairEvidence terms_of(const PairResult& result) {
  PairEvidence evidence;
  for (const auto& [name, value] : result.evidence) {
    if (name == "score") evidence.score = value;
    if (name == "near_score") evidence.near_score = value;
    if (name == "rival_score") evidence.rival_score = value;
    if (name == "contradiction") evidence.contradiction = value;
    if (name == "support") evidence.support = value;
    if (name == "rare_support") evidence.rare_support = value;
    if (name == "observability") evidence.observability = value;
    if (name == "free_space") evidence.free_space = value > 0;
    if (name == "passed_over") evidence.passed_over = value;
  }
  return evidence;
}

}  // namespace

double probability_of(const PairEvidence& e) {
  // Logistic regression over 615 pairs; the table of sets and the check with each place left out in turn are in
  // docs/stages/verdict.md. The floors keep tiny scores from looking like clear margins.
  constexpr double kIntercept = -1.95, kLogScore = 1.51, kLogMargin = 3.41, kNear = -1.56, kFreeSpace = 1.98,
                   kContradiction = -3.71;
  constexpr double kLeastScore = 1e-3, kLeastRival = 0.01, kUsualShare = 0.01;
  constexpr double kVetoedProbability = 0.5, kSlidingProbability = 0.9;
  constexpr double kSecondProbability = 0.5;      // in a tunnel one such pose was sure otherwise, a bay off
  constexpr double kUnobservedProbability = 0.1;  // of 317 such pairs 4 were right
  const double score = std::max(e.score, kLeastScore);
  const double logit = kIntercept + kLogScore * (std::log(score) + 3) +
                       kLogMargin * std::log(score / std::max(e.rival_score, kLeastRival)) +
                       kNear * std::min(e.near_score / score, 1.0) + (e.free_space ? kFreeSpace : 0.0) +
                       // Stations that see nearly the same do not contradict each other; at the edges of what little is
                       // shared they do.
                       kContradiction * e.support * std::log(1 + contradicting_share(e) / kUsualShare);
  const double p = 1 / (1 + std::exp(-logit));
  if (unobserved(e)) return std::min(p, kUnobservedProbability);
  if (vetoed(e)) return std::min(p, kVetoedProbability);
  if (e.passed_over > 0) return std::min(p, kSecondProbability);
  if (slides(e)) return std::min(p, kSlidingProbability);
  return doubtful(e) ? std::min(p, kDoubtfulProbability) : p;
}

double probability_against(const PairResult& result, double rival_score) {
  PairEvidence evidence = terms_of(result);
  evidence.rival_score = rival_score;
  return probability_of(evidence);
}

double contradicting_share(const PairResult& result) { return contradicting_share(terms_of(result)); }

bool forbidden_by_free_space(const PairResult& result) {
  const PairEvidence e = terms_of(result);
  if (vetoed(e) || e.passed_over > 0) return true;
  constexpr double kSure = 0.95;
  // Halls of equal bays are sure of the wrong bay: but what supports them there supports other hypotheses as well. Of
  // 138 such poses beyond the limit 2 were right; of streets with passers-by, beyond it too, all have more than 0.7.
  constexpr double kCommonplace = 0.5;
  const bool commonplace = e.rare_support < kCommonplace * e.support;
  if (result.probability > kSure && !commonplace) return false;
  return laid_on_its_equal(e.contradiction, result.overlap);
}

double free_space_discount(double overlap, double contradiction) {
  // Of 667 right best poses that explain a tenth 8 % are laid on their equal, of 309 wrong ones 13 %, and vetoed are
  // 0.6 and 53 %; in buildings alone the wrong ones are nearly all either. Odds go with the power 3.4 of a margin.
  constexpr double kLaidOnEqual = 2.2;
  if (vetoed(contradiction, overlap)) return kMostDiscount;
  return laid_on_its_equal(contradiction, overlap) ? kLaidOnEqual : 1;
}

void judge(const PairEvidence& e, const PairOptions& options, PairResult& result) {
  result.evidence = {{"score", e.score},
                     {"near_score", e.near_score},
                     {"rival_score", e.rival_score},
                     {"rival_voxels", e.rival_voxels},
                     {"rival_deg", e.rival_deg},
                     {"support", e.support},
                     {"rare_support", e.rare_support},
                     {"contradiction", e.contradiction},
                     {"against", e.against},
                     {"rms_voxels", e.rms_voxels},
                     {"observability", e.observability},
                     {"num_supported", e.num_supported},
                     {"free_space", e.free_space ? 1.0 : 0.0},
                     {"passed_over", e.passed_over},
                     {"share_under_6mm", e.share_under_6mm},
                     {"share_under_20mm", e.share_under_20mm}};
  result.probability = probability_of(e);
  const bool forbidden = forbidden_by_free_space(result);
  if (forbidden) result.probability = std::min(result.probability, kDoubtfulProbability);
  if (result.probability >= options.accept_probability && !forbidden) {
    result.verdict = Verdict::accepted;
    result.reason = fmt::format("{:.0f} % of the smaller scan is explained and no rival comes near", 100 * e.support);
    return;
  }
  result.verdict = result.probability >= options.ambiguous_probability ? Verdict::ambiguous : Verdict::rejected;
  constexpr double kClearMargin = 1.5;
  if (e.passed_over > 0)
    result.reason = fmt::format("a pose that explains {:.0f} % more stands where the other station saw through",
                                100 * (e.passed_over / std::max(e.score, 1e-9) - 1));
  else if (forbidden || (doubtful(e) && result.probability >= kDoubtfulProbability))
    result.reason =
        fmt::format("{:.1f} % of the points stand where the other station saw through", 100 * e.contradiction);
  else if (unobserved(e) && e.support > 0)
    result.reason = fmt::format(
        "nothing fixes the place along one direction: {:.0f} % of the smaller scan is explained, but it slides",
        100 * e.support);
  else if (slides(e) && e.score >= kClearMargin * e.rival_score)
    result.reason = fmt::format("the place is hardly fixed: a neighbouring pose explains {:.0f} % as much",
                                100 * std::min(1.0, e.near_score / std::max(e.score, 1e-9)));
  else if (e.score < kClearMargin * e.rival_score)
    result.reason =
        fmt::format("a rival pose, {:.0f} voxels and {:.0f} degrees away, explains the scans {:.0f} % as well",
                    e.rival_voxels, e.rival_deg, 100 * std::min(1.0, e.rival_score / std::max(e.score, 1e-9)));
  else
    result.reason = fmt::format("only {:.1f} % of the smaller scan is explained", 100 * e.support);
}

}  // namespace isthmus
