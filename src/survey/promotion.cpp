#include "survey/promotion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "survey/spanning_forest.h"

namespace isthmus::survey {
namespace {

// Agreement that is to count as evidence must be tight whatever the uncertainties are: this many noise floors (two
// voxels with the default floor of a quarter voxel), in translation and, at the scan's radius, in rotation.
constexpr double kTightFloors = 8.0;
// Links tried per pair of parts when a loop around three parts is sought.
constexpr std::size_t kLinksPerSide = 3;

double probability_of(const Measurement& m) { return 1.0 / (1.0 + std::exp(-m.log_odds)); }

/// Posterior that links with these probabilities are all right, given that they agree: if any is wrong, they agree by
/// chance.
double joint_probability(double all_right, const SolveOptions& options) {
  return all_right / (all_right + (1.0 - all_right) * options.chance_closure);
}

bool agrees_tightly(const Relative& a, const Relative& b, const NoiseModel& noise, const SolveOptions& options) {
  const Vector6d d = disagreement(a.b_from_a, b.b_from_a);
  return d.head<3>().norm() <= kTightFloors * noise.floor_m && d.tail<3>().norm() <= kTightFloors * noise.floor_rad &&
         chi2_of(d, a.covariance + b.covariance) <= options.agreement_chi2;
}

/// b_from_a within one part: the solved poses, with the uncertainty of the shortest path between them.
struct Walk {
  Relative b_from_a;
  std::vector<int> path;
};
Walk walk(const SolvedParts& parts, int a, int b) {
  Walk w;
  w.path = shortest_path(parts.num_nodes, parts.measurements, parts.accepted, a, b);
  w.b_from_a.covariance = along(parts.measurements, w.path, a).covariance;
  w.b_from_a.b_from_a = parts.root_from_node[b].inverse() * parts.root_from_node[a];
  return w;
}

using PartPair = std::pair<int, int>;  // smaller part first

/// Ambiguous links between different parts, most probable first.
std::map<PartPair, std::vector<int>> links_between_parts(const SolvedParts& parts) {
  std::map<PartPair, std::vector<int>> between;
  for (int e = 0; e < static_cast<int>(parts.measurements.size()); ++e) {
    const Measurement& m = parts.measurements[e];
    const int a = parts.part[m.source], b = parts.part[m.target];
    if (!parts.accepted[e] && m.votes && a != b) between[{std::min(a, b), std::max(a, b)}].push_back(e);
  }
  for (auto& [pair, links] : between)
    std::stable_sort(links.begin(), links.end(),
                     [&](int x, int y) { return parts.measurements[x].log_odds > parts.measurements[y].log_odds; });
  return between;
}

int end_in(const SolvedParts& parts, const Measurement& m, int part) {
  return parts.part[m.source] == part ? m.source : m.target;
}

/// What link `via` between parts `from` and `to` predicts for link `of` between the same parts.
Relative predicted_by(const SolvedParts& parts, int via, int of, int from) {
  const Measurement& v = parts.measurements[via];
  const Measurement& o = parts.measurements[of];
  const int v_from = end_in(parts, v, from), o_from = end_in(parts, o, from);
  const int v_to = v_from == v.source ? v.target : v.source, o_to = o_from == o.source ? o.target : o.source;
  const Relative r = compose(walked_from(v, v_from), walk(parts, o_from, v_from).b_from_a);
  return compose(walk(parts, v_to, o_to).b_from_a, r);
}

struct Join {
  std::vector<int> links;
  double probability = 0;
};

/// Groups of links between two parts by their joint transform; the best group against its rivals and against "all are
/// wrong".
Join best_group(const SolvedParts& parts, const std::vector<int>& links, int from, const std::vector<NoiseModel>& noise,
                const SolveOptions& options) {
  std::vector<std::vector<int>> groups;
  for (const int e : links) {
    const Measurement& m = parts.measurements[e];
    const int start = end_in(parts, m, from);
    const auto home = std::find_if(groups.begin(), groups.end(), [&](const std::vector<int>& g) {
      return agrees_tightly(walked_from(m, start), predicted_by(parts, g.front(), e, from), noise[start], options);
    });
    if (home == groups.end())
      groups.push_back({e});
    else
      home->push_back(e);
  }
  // Odds of "group g is right" against "all are wrong and agree by chance": each link brings its own odds, and g's
  // members' agreement needs no chance any more.
  std::vector<double> odds;
  double total = 1.0;
  for (const std::vector<int>& g : groups) {
    double log_odds = static_cast<double>(g.size() - 1) * std::log(1.0 / options.chance_closure);
    for (const int e : g) log_odds += parts.measurements[e].log_odds;
    total += odds.emplace_back(std::exp(log_odds));
  }
  Join best;
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (groups[g].size() >= 2 && odds[g] / total > best.probability) best = {groups[g], odds[g] / total};
  return best;
}

/// Loop around three parts made of one ambiguous link between each two of them.
bool closes(const SolvedParts& parts, const std::array<int, 3>& links, const std::array<int, 3>& corner,
            const std::vector<NoiseModel>& noise, const SolveOptions& options) {
  // links[0] joins corners 0 and 1, links[1] corners 1 and 2, links[2] corners 0 and 2: walk 0 -> 1 -> 2 and compare.
  const Measurement& last = parts.measurements[links[2]];
  const int start = end_in(parts, last, corner[0]);
  const int goal = start == last.source ? last.target : last.source;
  Relative r;
  int at = start;
  for (int k = 0; k < 2; ++k) {
    const Measurement& m = parts.measurements[links[k]];
    const int leave = end_in(parts, m, corner[k]);
    r = compose(walked_from(m, leave), compose(walk(parts, at, leave).b_from_a, r));
    at = leave == m.source ? m.target : m.source;
  }
  r = compose(walk(parts, at, goal).b_from_a, r);
  return agrees_tightly(walked_from(last, start), r, noise[start], options);
}

Join best_triangle(const SolvedParts& parts, const std::map<PartPair, std::vector<int>>& between,
                   const std::vector<NoiseModel>& noise, const SolveOptions& options) {
  Join best;
  const auto side = [&](int a, int b) -> std::vector<int> {
    const auto found = between.find({a, b});
    if (found == between.end()) return {};
    return {found->second.begin(), found->second.begin() + std::min(found->second.size(), kLinksPerSide)};
  };
  for (const auto& [ab, links_ab] : between)
    for (const auto& [bc, links_bc] : between) {
      if (ab.second != bc.first) continue;
      for (const int x : side(ab.first, ab.second))
        for (const int y : side(bc.first, bc.second))
          for (const int z : side(ab.first, bc.second)) {
            const double all_right = probability_of(parts.measurements[x]) * probability_of(parts.measurements[y]) *
                                     probability_of(parts.measurements[z]);
            const double probability = joint_probability(all_right, options);
            if (probability > best.probability && probability >= options.promote_probability &&
                closes(parts, {x, y, z}, {ab.first, ab.second, bc.second}, noise, options))
              best = {{x, y, z}, probability};
          }
    }
  return best;
}

}  // namespace

std::vector<Promotion> confirmed_within_parts(const SolvedParts& parts, const std::vector<NoiseModel>& noise,
                                              const SolveOptions& options) {
  std::vector<Promotion> out;
  for (int e = 0; e < static_cast<int>(parts.measurements.size()); ++e) {
    const Measurement& m = parts.measurements[e];
    if (parts.accepted[e] || parts.part[m.source] != parts.part[m.target]) continue;
    const double probability = joint_probability(probability_of(m), options);
    if (!m.votes || probability < options.promote_probability) continue;
    Walk w = walk(parts, m.source, m.target);
    if (agrees_tightly(m.target_from_source, w.b_from_a, noise[m.source], options))
      out.push_back({e, std::move(w.path), false, probability});
  }
  return out;
}

std::vector<Promotion> best_join(const SolvedParts& parts, const std::vector<NoiseModel>& noise,
                                 const SolveOptions& options) {
  const std::map<PartPair, std::vector<int>> between = links_between_parts(parts);
  Join best;
  for (const auto& [pair, links] : between) {
    const Join join = best_group(parts, links, pair.first, noise, options);
    if (join.probability > best.probability) best = join;
  }
  if (best.probability < options.promote_probability) best = best_triangle(parts, between, noise, options);
  std::vector<Promotion> out;
  if (best.probability < options.promote_probability) return out;
  for (const int e : best.links) {
    std::vector<int> others = best.links;
    std::erase(others, e);
    out.push_back({e, std::move(others), true, best.probability});
  }
  return out;
}

}  // namespace isthmus::survey
