#include "survey/promotion.h"

#include <cmath>
#include <utility>

#include "survey/cut_groups.h"
#include "survey/spanning_forest.h"

namespace isthmus::survey {

// A link that is by itself more likely wrong must agree twice as closely: what it adds to poses that are there without
// it is little, and one that is two voxels off is wrong.
constexpr double kCloser = 2;
constexpr double kUnlikelyLogOdds = -0.85;  // p = 0.3

std::vector<ConfirmedLink> confirmed_within_parts(const SolvedParts& parts, const SolveOptions& options) {
  std::vector<ConfirmedLink> out;
  for (int e = 0; e < static_cast<int>(parts.measurements.size()); ++e) {
    const Measurement& m = parts.measurements[e];
    if (parts.believed[e] || !m.votes || parts.part[m.source] != parts.part[m.target]) continue;
    if (probability_of(agreeing_vote(m, options)) < options.promote_probability) continue;
    const Transform predicted = parts.root_from_node[m.target].inverse() * parts.root_from_node[m.source];
    const Vector6d d = disagreement(m.target_from_source.b_from_a, predicted);
    if (!is_tight(m.log_odds < kUnlikelyLogOdds ? kCloser * d : d, m)) continue;
    std::vector<int> path = shortest_path(parts.num_nodes, parts.measurements, parts.believed, m.source, m.target);
    const Relative walked = along(parts.measurements, path, m.source);
    if (chi2_of(d, m.target_from_source.covariance + walked.covariance) <= options.agreement_chi2)
      out.push_back({e, std::move(path)});
  }
  return out;
}

}  // namespace isthmus::survey
