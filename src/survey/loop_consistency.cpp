#include "survey/loop_consistency.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace isthmus::survey {
namespace {

/// The links still in play, and the means to compare them.
struct Judge {
  int num_nodes;
  std::span<const Measurement> measurements;
  const SolveOptions& options;
  std::vector<int> active;  // ascending

  [[nodiscard]] bool agrees(const Relative& a, const Relative& b) const {
    return chi2_of(disagreement(a.b_from_a, b.b_from_a), a.covariance + b.covariance) <= options.agreement_chi2;
  }
  [[nodiscard]] bool agrees_with_tree(const SpanningForest& forest, int e) const {
    const Measurement& m = measurements[e];
    return agrees(m.target_from_source, along(measurements, tree_path(forest, m.source, m.target), m.source));
  }
};

/// Per measurement, how many triangles of active links through it close.
std::vector<int> closing_triangles(const Judge& judge) {
  std::vector<int> closing(judge.measurements.size(), 0);
  std::vector<std::map<int, std::vector<int>>> neighbours(static_cast<std::size_t>(judge.num_nodes));
  for (const int e : judge.active) {
    const Measurement& m = judge.measurements[e];
    neighbours[std::min(m.source, m.target)][std::max(m.source, m.target)].push_back(e);
  }
  const auto try_triangle = [&](int i, int ij, int jk, int ik, int j) {
    const Relative k_from_i = compose(walked_from(judge.measurements[jk], j), walked_from(judge.measurements[ij], i));
    if (!judge.agrees(walked_from(judge.measurements[ik], i), k_from_i)) return;
    ++closing[ij], ++closing[jk], ++closing[ik];
  };
  for (int i = 0; i < judge.num_nodes; ++i)
    for (const auto& [j, edges_ij] : neighbours[i])
      for (const auto& [k, edges_jk] : neighbours[j]) {
        const auto closing_edge = neighbours[i].find(k);
        if (closing_edge == neighbours[i].end()) continue;
        for (const int ij : edges_ij)
          for (const int jk : edges_jk)
            for (const int ik : closing_edge->second) try_triangle(i, ij, jk, ik, j);
      }
  return closing;
}

/// Best first: links that close triangles, then probable ones, then those with much overlap.
std::vector<int> tree_order(const Judge& judge) {
  const std::vector<int> closing = closing_triangles(judge);
  std::vector<int> order = judge.active;
  const double closure = std::log(1.0 / judge.options.chance_closure);
  const auto weight = [&](int e) { return judge.measurements[e].log_odds + closing[e] * closure; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    if (weight(a) != weight(b)) return weight(a) > weight(b);
    return judge.measurements[a].overlap > judge.measurements[b].overlap;
  });
  return order;
}

/// Links across the cut that removing one tree edge opens, grouped by the joint transform they agree on.
struct CutGroup {
  std::vector<int> members;  // the representative first
  double score = 0;
};

std::vector<char> below_edge(const SpanningForest& forest, int tree_edge) {
  std::vector<char> below(forest.parent.size(), 0);
  std::vector<int> by_depth(forest.parent.size());
  for (std::size_t i = 0; i < by_depth.size(); ++i) by_depth[i] = static_cast<int>(i);
  std::stable_sort(by_depth.begin(), by_depth.end(), [&](int a, int b) { return forest.depth[a] < forest.depth[b]; });
  for (const int node : by_depth)
    below[node] = forest.parent_edge[node] == tree_edge || (forest.parent[node] >= 0 && below[forest.parent[node]]);
  return below;
}

/// What the link `via` across the cut predicts for the link `of`: of's upper end from its lower end.
Relative predicted_across(const Judge& judge, const SpanningForest& forest, const std::vector<char>& below, int via,
                          int of) {
  const Measurement& v = judge.measurements[via];
  const Measurement& o = judge.measurements[of];
  const int v_low = below[v.source] ? v.source : v.target, v_high = below[v.source] ? v.target : v.source;
  const int o_low = below[o.source] ? o.source : o.target, o_high = below[o.source] ? o.target : o.source;
  Relative r = along(judge.measurements, tree_path(forest, o_low, v_low), o_low);
  r = compose(walked_from(v, v_low), r);
  return compose(along(judge.measurements, tree_path(forest, v_high, o_high), v_high), r);
}

std::vector<CutGroup> groups_across(const Judge& judge, const SpanningForest& forest, int tree_edge) {
  const std::vector<char> below = below_edge(forest, tree_edge);
  std::vector<int> crossing;
  for (const int e : judge.active)
    if (e != tree_edge && below[judge.measurements[e].source] != below[judge.measurements[e].target])
      crossing.push_back(e);
  std::stable_sort(crossing.begin(), crossing.end(),
                   [&](int a, int b) { return judge.measurements[a].log_odds > judge.measurements[b].log_odds; });
  std::vector<CutGroup> groups{{{tree_edge}, vote_of(judge.measurements[tree_edge], judge.options)}};
  for (const int e : crossing) {
    const Measurement& m = judge.measurements[e];
    const Relative own = walked_from(m, below[m.source] ? m.source : m.target);
    const auto home = std::find_if(groups.begin(), groups.end(), [&](const CutGroup& g) {
      return judge.agrees(own, predicted_across(judge, forest, below, g.members.front(), e));
    });
    if (home == groups.end())
      groups.push_back({{e}, vote_of(m, judge.options)});
    else
      home->members.push_back(e), home->score += vote_of(m, judge.options);
  }
  return groups;
}

std::vector<int> disagreeing(const Judge& judge, const SpanningForest& forest, const std::vector<int>& tree) {
  std::vector<int> out;
  for (const int e : judge.active)
    if (!std::binary_search(tree.begin(), tree.end(), e) && !judge.agrees_with_tree(forest, e)) out.push_back(e);
  return out;
}

/// Exchanges tree edges for links with more agreement behind them. Every exchange raises the summed votes of the links
/// that agree with the tree, so this ends.
std::vector<int> improved_tree(const Judge& judge, std::vector<int> tree) {
  for (bool changed = true; changed;) {
    changed = false;
    const SpanningForest forest = forest_of(judge.num_nodes, judge.measurements, tree);
    std::set<int> suspects;  // tree edges on a loop that does not close
    for (const int e : disagreeing(judge, forest, tree))
      for (const int t : tree_path(forest, judge.measurements[e].source, judge.measurements[e].target))
        suspects.insert(t);
    for (const int t : suspects) {
      const std::vector<CutGroup> groups = groups_across(judge, forest, t);
      const auto best = std::max_element(groups.begin(), groups.end(),
                                         [](const CutGroup& a, const CutGroup& b) { return a.score < b.score; });
      if (best->score <= groups.front().score + 1e-9) continue;
      std::replace(tree.begin(), tree.end(), t, best->members.front());
      std::sort(tree.begin(), tree.end());
      changed = true;
      break;  // the other cuts have changed with the tree
    }
  }
  return tree;
}

/// Rejects the disagreeing link e, and those tree edges of its loop that are as likely to be the wrong one.
void reject(const Judge& judge, const SpanningForest& forest, int e, std::map<int, LoopRejection>& rejections) {
  const Measurement& m = judge.measurements[e];
  const std::vector<int> path = tree_path(forest, m.source, m.target);
  const LoopError error = error_against_path(judge.measurements, m, path);
  double total = 1.0;  // weight of "e is the wrong one"
  std::vector<double> weights;
  for (const int t : path) {
    const std::vector<CutGroup> groups = groups_across(judge, forest, t);
    const auto own = std::find_if(groups.begin(), groups.end(), [&](const CutGroup& g) {
      return std::find(g.members.begin(), g.members.end(), e) != g.members.end();
    });
    weights.push_back(std::exp(own->score - groups.front().score));
    total += weights.back();
  }
  for (std::size_t k = 0; k < path.size(); ++k)
    if (weights[k] / total > judge.options.undecided_wrong_probability) rejections[path[k]] = {path[k], error, true};
  rejections[e] = {e, error, 1.0 / total < 1.0 - judge.options.undecided_wrong_probability};
}

}  // namespace

double vote_of(const Measurement& m, const SolveOptions& options) {
  if (!m.votes) return 0;  // it was told where to look
  return std::max(0.0, m.log_odds) + std::log(1.0 / options.chance_closure);
}

LoopError error_against_path(std::span<const Measurement> measurements, const Measurement& m,
                             const std::vector<int>& path) {
  const Relative other = along(measurements, path, m.source);
  const Vector6d d = disagreement(m.target_from_source.b_from_a, other.b_from_a);
  return {nodes_of_path(measurements, path, m.source), d.tail<3>().norm(), d.head<3>().norm(),
          chi2_of(d, m.target_from_source.covariance + other.covariance)};
}

LoopJudgement judge_loops(int num_nodes, std::span<const Measurement> measurements, const SolveOptions& options) {
  Judge judge{num_nodes, measurements, options, {}};
  for (int e = 0; e < static_cast<int>(measurements.size()); ++e) judge.active.push_back(e);
  std::map<int, LoopRejection> all;
  for (;;) {
    const std::vector<int> tree = improved_tree(judge, spanning_edges(num_nodes, measurements, tree_order(judge)));
    const SpanningForest forest = forest_of(num_nodes, measurements, tree);
    std::map<int, LoopRejection> now;
    for (const int e : disagreeing(judge, forest, tree)) reject(judge, forest, e, now);
    if (now.empty()) {
      LoopJudgement out{tree, {}};
      for (const auto& [e, rejection] : all) out.rejections.push_back(rejection);
      return out;
    }
    std::erase_if(judge.active, [&](int e) { return now.contains(e); });
    all.merge(now);
  }
}

}  // namespace isthmus::survey
