#include "pairwise/judge.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace isthmus {

double probability_of(const PairEvidence& e) {
  // Coefficients of a logistic regression; see docs/stages/verdict.md.
  const double score = std::log(std::max(e.score, 1e-4));
  const double margin = std::log(std::max(e.score, 1e-4) / std::max(e.rival_score, 5e-3));
  const double contradiction = std::min(e.contradiction, 0.2);
  const double points = std::log(std::max(e.num_supported, 1.0));
  const double logit = -2.0 + 1.0 * (score + 3.0) + 4.0 * margin - 40.0 * contradiction + 0.5 * (points - 6.0);
  return 1.0 / (1.0 + std::exp(-logit));
}

void judge(const PairEvidence& e, const PairOptions& options, PairResult& result) {
  result.evidence = {{"score", e.score},
                     {"rival_score", e.rival_score},
                     {"support", e.support},
                     {"rare_support", e.rare_support},
                     {"contradiction", e.contradiction},
                     {"against", e.against},
                     {"rms_voxels", e.rms_voxels},
                     {"observability", e.observability},
                     {"num_supported", e.num_supported},
                     {"free_space", e.free_space ? 1.0 : 0.0}};
  result.probability = probability_of(e);
  if (result.probability >= options.accept_probability) {
    result.verdict = Verdict::accepted;
    result.reason = fmt::format("{:.0f} % of the smaller scan is explained and no rival comes near", 100 * e.support);
    return;
  }
  result.verdict = result.probability >= options.ambiguous_probability ? Verdict::ambiguous : Verdict::rejected;
  constexpr double kClearMargin = 1.5, kMuchContradiction = 0.03;
  if (e.contradiction > kMuchContradiction)
    result.reason = fmt::format("{:.1f} % of the points stand where the other station saw through", 100 * e.contradiction);
  else if (e.score < kClearMargin * e.rival_score)
    result.reason = fmt::format("a rival pose explains the scans {:.0f} % as well", 100 * std::min(1.0, e.rival_score / std::max(e.score, 1e-9)));
  else
    result.reason = fmt::format("only {:.1f} % of the smaller scan is explained", 100 * e.support);
}

}  // namespace isthmus
