#include "survey/cut_groups.h"

#include <algorithm>
#include <cmath>

namespace isthmus::survey {
namespace {

// An accepted link counts for something even if a configuration accepts below one half.
constexpr double kLeastAcceptedVote = 0.01;

enum class Relation { contradicts, silent, confirms };

struct Ends {
  int low, high;
};
Ends ends_of(const Measurement& m, const std::vector<Side>& sides) {
  return sides[m.source] == Side::low ? Ends{m.source, m.target} : Ends{m.target, m.source};
}

/// What the link `via` predicts for the link `of` across the same cut: walk on the low side, cross, walk on the high
/// side.
struct Crossing {
  const LinksInPlay& links;
  const SpanningForest& forest;
  const std::vector<Side>& sides;

  [[nodiscard]] Relation relation(int via, int of) const {
    const Measurement& v = links.measurements[via];
    const Measurement& o = links.measurements[of];
    const Ends ve = ends_of(v, sides), oe = ends_of(o, sides);
    const Relative own = walked_from(o, oe.low);
    const auto step = [&](int from, int to) {
      return forest.root_from_node[to].inverse() * forest.root_from_node[from];
    };
    const Transform predicted = step(ve.high, oe.high) * walked_from(v, ve.low).b_from_a * step(oe.low, ve.low);
    const Vector6d d = disagreement(own.b_from_a, predicted);
    const bool tight = is_tight(d, o);
    // Nothing is lost when an ambiguous link is called contradicting, so its covariance need not be known.
    if (!tight && !o.accepted) return Relation::contradicts;
    Relative r = along(links.measurements, tree_path(forest, oe.low, ve.low), oe.low);
    r = compose(walked_from(v, ve.low), r);
    r = compose(along(links.measurements, tree_path(forest, ve.high, oe.high), ve.high), r);
    if (chi2_of(d, own.covariance + r.covariance) > links.options->agreement_chi2) return Relation::contradicts;
    return tight ? Relation::confirms : Relation::silent;
  }
};

}  // namespace

double own_vote(const Measurement& m) {
  if (!m.votes) return 0;
  return m.accepted ? std::max(kLeastAcceptedVote, m.log_odds) : m.log_odds;
}

double agreeing_vote(const Measurement& m, const SolveOptions& options) {
  return m.votes ? std::max(0.0, own_vote(m) + std::log(1.0 / options.chance_closure)) : 0.0;
}

std::vector<Side> sides_of_edge(const SpanningForest& forest, int tree_edge) {
  std::vector<int> by_depth(forest.parent.size());
  for (std::size_t i = 0; i < by_depth.size(); ++i) by_depth[i] = static_cast<int>(i);
  std::stable_sort(by_depth.begin(), by_depth.end(), [&](int a, int b) { return forest.depth[a] < forest.depth[b]; });
  std::vector<Side> sides(forest.parent.size(), Side::neither);
  int root = -1;
  for (const int node : by_depth) {
    const int up = forest.parent[node];
    if (forest.parent_edge[node] == tree_edge && up >= 0) root = forest.root[node];
    if (up >= 0 && (forest.parent_edge[node] == tree_edge || sides[up] == Side::low)) sides[node] = Side::low;
  }
  for (const int node : by_depth)
    if (sides[node] == Side::neither && forest.root[node] == root) sides[node] = Side::high;
  return sides;
}

std::vector<Side> sides_of_parts(const SpanningForest& forest, int low_root, int high_root) {
  std::vector<Side> sides;
  for (const int root : forest.root)
    sides.push_back(root == low_root ? Side::low : root == high_root ? Side::high : Side::neither);
  return sides;
}

std::vector<CutGroup> groups_across(const LinksInPlay& links, const SpanningForest& forest,
                                    const std::vector<Side>& sides, int first) {
  std::vector<int> crossing;
  for (const int e : links.active) {
    const Side a = sides[links.measurements[e].source], b = sides[links.measurements[e].target];
    if (e != first && a != b && a != Side::neither && b != Side::neither) crossing.push_back(e);
  }
  std::stable_sort(crossing.begin(), crossing.end(),
                   [&](int a, int b) { return own_vote(links.measurements[a]) > own_vote(links.measurements[b]); });
  if (first >= 0) crossing.insert(crossing.begin(), first);
  const Crossing cut{links, forest, sides};
  std::vector<CutGroup> groups;
  for (const int e : crossing) {
    const Measurement& m = links.measurements[e];
    Relation relation = Relation::contradicts;
    const auto home = std::find_if(groups.begin(), groups.end(), [&](const CutGroup& g) {
      relation = cut.relation(g.members.front(), e);
      return relation != Relation::contradicts;
    });
    const bool trusted = m.accepted && m.votes;
    if (home == groups.end()) {
      groups.push_back({{e}, {e}, own_vote(m), trusted});
      continue;
    }
    home->members.push_back(e);
    home->has_accepted = home->has_accepted || trusted;
    if (relation == Relation::silent) continue;
    home->confirming.push_back(e);
    home->score += agreeing_vote(m, *links.options);
  }
  return groups;
}

}  // namespace isthmus::survey
