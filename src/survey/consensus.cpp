#include "survey/consensus.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace isthmus::survey {
namespace {

bool in(const std::vector<int>& sorted, int value) { return std::binary_search(sorted.begin(), sorted.end(), value); }

bool agrees(const LinksInPlay& links, const Measurement& m, const Relative& other, const Measurement& unit) {
  const Relative own = m.target_from_source;
  const Vector6d d = disagreement(own.b_from_a, other.b_from_a);
  return is_tight(d, unit) && chi2_of(d, own.covariance + other.covariance) <= links.options->agreement_chi2;
}

/// Per measurement, how many triangles of links in play through it close.
std::vector<int> closing_triangles(const LinksInPlay& links) {
  std::vector<int> closing(links.measurements.size(), 0);
  std::vector<std::map<int, std::vector<int>>> later(
      static_cast<std::size_t>(links.num_nodes));  // per node: greater ends
  for (const int e : links.active) {
    const Measurement& m = links.measurements[e];
    if (m.votes) later[std::min(m.source, m.target)][std::max(m.source, m.target)].push_back(e);
  }
  const auto try_triangle = [&](int ij, int jk, int ik) {
    const Measurement& side = links.measurements[ik];
    const int i = side.source;
    const bool starts_with_ij = links.measurements[ij].source == i || links.measurements[ij].target == i;
    const int first = starts_with_ij ? ij : jk, second = starts_with_ij ? jk : ij;
    const Measurement& f = links.measurements[first];
    const int middle = f.source == i ? f.target : f.source;
    const Relative around = compose(walked_from(links.measurements[second], middle), walked_from(f, i));
    if (!agrees(links, side, around, side)) return;
    ++closing[ij], ++closing[jk], ++closing[ik];
  };
  for (const auto& of_i : later)
    for (const auto& [j, edges_ij] : of_i)
      for (const auto& [k, edges_jk] : later[j]) {
        const auto edges_ik = of_i.find(k);
        if (edges_ik == of_i.end()) continue;
        for (const int ij : edges_ij)
          for (const int jk : edges_jk)
            for (const int ik : edges_ik->second) try_triangle(ij, jk, ik);
      }
  return closing;
}

/// Links that may start a tree, best first: those that close triangles, then probable ones, then those with much
/// overlap. Ambiguous links that are more likely wrong than right and close nothing stay out: they can still join parts
/// as a group.
std::vector<int> tree_order(const LinksInPlay& links) {
  const std::vector<int> closing = closing_triangles(links);
  const double closure = std::log(1.0 / links.options->chance_closure);
  const auto weight = [&](int e) { return own_vote(links.measurements[e]) + closing[e] * closure; };
  std::vector<int> order;
  for (const int e : links.active)
    if (links.measurements[e].accepted || links.measurements[e].doubted || weight(e) > 0) order.push_back(e);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    if (weight(a) != weight(b)) return weight(a) > weight(b);
    return links.measurements[a].overlap > links.measurements[b].overlap;
  });
  return order;
}

const CutGroup& best_of(const std::vector<CutGroup>& groups) {
  return *std::max_element(groups.begin(), groups.end(),
                           [](const CutGroup& a, const CutGroup& b) { return a.score < b.score; });
}

/// Joins two parts of the forest by the best group of links between any two, if there is one better than none.
bool join_parts(const LinksInPlay& links, std::vector<int>& tree) {
  const SpanningForest forest = forest_of(links.num_nodes, links.measurements, tree);
  std::set<std::pair<int, int>> neighbours;
  for (const int e : links.active) {
    const int a = forest.root[links.measurements[e].source], b = forest.root[links.measurements[e].target];
    if (a != b) neighbours.insert(std::minmax(a, b));
  }
  double best_score = 0;
  int best = -1;
  for (const auto& [a, b] : neighbours) {
    const std::vector<CutGroup> groups = groups_across(links, forest, sides_of_parts(forest, a, b), -1);
    const CutGroup& group = best_of(groups);
    if (group.score > best_score) best_score = group.score, best = group.members.front();
  }
  if (best < 0) return false;
  tree.insert(std::upper_bound(tree.begin(), tree.end(), best), best);
  return true;
}

/// Replaces one tree edge by the best link of a group with more votes across the same cut.
bool exchange(const LinksInPlay& links, std::vector<int>& tree) {
  const SpanningForest forest = forest_of(links.num_nodes, links.measurements, tree);
  for (int& t : tree) {
    const std::vector<CutGroup> groups = groups_across(links, forest, sides_of_edge(forest, t), t);
    const CutGroup& best = best_of(groups);
    if (best.score <= groups.front().score + 1e-9) continue;
    t = best.members.front();
    std::sort(tree.begin(), tree.end());
    return true;
  }
  return false;
}

/// Every join and every exchange raises the summed votes of what agrees with the forest, so this ends.
/// `start`: links of an earlier tree, those still in play come first.
std::vector<int> search(const LinksInPlay& links, const std::vector<int>& start) {
  std::vector<int> order;
  for (const int e : start)
    if (in(links.active, e)) order.push_back(e);
  const std::vector<int> others = tree_order(links);
  order.insert(order.end(), others.begin(), others.end());
  std::vector<int> tree = spanning_edges(links.num_nodes, links.measurements, order);
  while (join_parts(links, tree) || exchange(links, tree)) {
  }
  return tree;
}

/// What the links across the cut of one tree edge say about it.
struct CutJudgement {
  int tree_edge = 0;
  std::vector<CutGroup> groups;
  double share = 1;        ///< probability of the first group, given that one of the groups is right
  double probability = 1;  ///< the same when all may be wrong
};

CutJudgement judged(const LinksInPlay& links, const SpanningForest& forest, int t) {
  CutJudgement j{t, groups_across(links, forest, sides_of_edge(forest, t), t), 1, 1};
  double rivals = 0;
  for (std::size_t g = 1; g < j.groups.size(); ++g) rivals += std::exp(j.groups[g].score - j.groups[0].score);
  j.share = 1.0 / (1.0 + rivals);
  j.probability = 1.0 / (1.0 + rivals + std::exp(-j.groups[0].score));
  return j;
}

/// Alone against "all are wrong": a group of ambiguous links that would be believed if its rivals were gone.
bool sufficient(const CutGroup& group, const SolveOptions& options) {
  return group.confirming.size() >= 2 && probability_of(group.score) >= options.promote_probability;
}

/// Takes links out of play whose cut holds by ambiguous links that do not convince; true if any.
bool drop_weak(LinksInPlay& links, const std::vector<CutJudgement>& cuts) {
  std::set<int> dropped;
  for (const CutJudgement& cut : cuts) {
    const CutGroup& own = cut.groups.front();
    if (own.has_accepted || !links.measurements[cut.tree_edge].votes) continue;
    if (own.confirming.size() >= 2 && cut.probability >= links.options->promote_probability) continue;
    dropped.insert(own.members.begin(), own.members.end());
    // Its rivals failed to decide against it, so they may not profit from its going.
    for (const CutGroup& rival : cut.groups)
      if (!rival.has_accepted && sufficient(rival, *links.options))
        dropped.insert(rival.members.begin(), rival.members.end());
  }
  std::erase_if(links.active, [&](int e) { return dropped.contains(e); });
  return !dropped.empty();
}

LoopError error_against_tree(const LinksInPlay& links, const SpanningForest& forest, int e) {
  const Measurement& m = links.measurements[e];
  const std::vector<int> path = tree_path(forest, m.source, m.target);
  const Vector6d d = disagreement(m.target_from_source.b_from_a, along(links.measurements, path, m.source).b_from_a);
  return {nodes_of_path(links.measurements, path, m.source), d.tail<3>().norm(), d.head<3>().norm()};
}

/// Rejects accepted links of cuts where they contradict each other without a clear winner; true if any.
bool reject_contested(LinksInPlay& links, const SpanningForest& forest, const std::vector<CutJudgement>& cuts,
                      std::map<int, LoopRejection>& rejections) {
  std::set<int> out;
  for (const CutJudgement& cut : cuts) {
    if (cut.share >= 1.0 - links.options->undecided_wrong_probability) continue;
    const int rival = cut.groups[1].members.front();
    for (const CutGroup& group : cut.groups)
      for (const int e : group.members) {
        out.insert(e);
        const bool in_tree = e == cut.tree_edge;
        if (links.measurements[e].accepted)
          rejections[e] = {e, error_against_tree(links, forest, in_tree ? rival : e), true};
      }
  }
  std::erase_if(links.active, [&](int e) { return out.contains(e); });
  return !out.empty();
}

void reject_disagreeing(const LinksInPlay& links, const SpanningForest& forest, const std::vector<int>& tree,
                        std::map<int, LoopRejection>& rejections) {
  for (const int e : links.active) {
    const Measurement& m = links.measurements[e];
    if (!m.accepted || in(tree, e) || forest.root[m.source] != forest.root[m.target]) continue;
    const Relative path = along(links.measurements, tree_path(forest, m.source, m.target), m.source);
    const Vector6d d = disagreement(m.target_from_source.b_from_a, path.b_from_a);
    if (chi2_of(d, m.target_from_source.covariance + path.covariance) > links.options->agreement_chi2)
      rejections[e] = {e, error_against_tree(links, forest, e), false};
  }
}

}  // namespace

Consensus find_consensus(int num_nodes, std::span<const Measurement> measurements, const SolveOptions& options) {
  LinksInPlay links{num_nodes, measurements, &options, {}};
  for (int e = 0; e < static_cast<int>(measurements.size()); ++e)
    if (measurements[e].accepted || (options.promote_ambiguous && measurements[e].votes)) links.active.push_back(e);
  std::map<int, LoopRejection> rejections;
  Consensus out;
  std::vector<CutJudgement> cuts;
  const bool any_doubted =
      std::any_of(measurements.begin(), measurements.end(), [](const Measurement& m) { return m.doubted; });
  for (;;) {  // every turn takes links out of play
    // Where most is doubted, turns are many and take little out each: the next search goes on from this one.
    out.tree = search(links, any_doubted ? out.tree : std::vector<int>());
    const SpanningForest forest = forest_of(num_nodes, measurements, out.tree);
    cuts.clear();
    for (const int t : out.tree) cuts.push_back(judged(links, forest, t));
    if (drop_weak(links, cuts) || reject_contested(links, forest, cuts, rejections)) continue;
    reject_disagreeing(links, forest, out.tree, rejections);
    break;
  }
  for (const auto& [e, rejection] : rejections) out.rejections.push_back(rejection);
  for (const CutJudgement& cut : cuts) {
    const std::size_t own = cut.groups.front().confirming.size();
    out.solid = out.solid && own >= 3;
    for (std::size_t g = 1; g < cut.groups.size(); ++g)
      out.solid = out.solid && 2 * cut.groups[g].confirming.size() <= own;
    if (measurements[cut.tree_edge].accepted) continue;
    std::vector<int> others = cut.groups.front().confirming;
    std::erase(others, cut.tree_edge);
    out.promotions.push_back({cut.tree_edge, std::move(others)});
  }
  return out;
}

}  // namespace isthmus::survey
