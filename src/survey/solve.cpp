#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "survey/consensus.h"
#include "survey/optimise.h"
#include "survey/pose_graph.h"
#include "survey/pose_uncertainty.h"
#include "survey/promotion.h"
#include "survey/spanning_forest.h"

namespace isthmus {
namespace {

using namespace survey;  // NOLINT: this file is the module's front door

// The dense normal matrix of this many scans takes 260 MB; larger surveys do without sigmas.
constexpr std::size_t kMaxScansForSigmas = 950;
// A loop named in a reason lists at most this many scans.
constexpr std::size_t kMaxNamedScans = 8;

constexpr double deg(double rad) { return rad * 180.0 / std::numbers::pi; }

/// Everything the steps share. Nodes are positions in `scans`, which is sorted by id.
struct Solver {
  const SolveOptions& options;
  double voxel_m;
  std::vector<GraphScan> scans;
  std::vector<SolvedLink> links;          // sorted
  std::vector<Measurement> measurements;  // of links measured accepted or ambiguous
  std::vector<int> tree;                  // measurements that most loops agree with, ascending
  std::vector<Transform> root_from_node;  // solved, centred frames
  std::vector<std::string> warnings;

  [[nodiscard]] int num_nodes() const { return static_cast<int>(scans.size()); }
  [[nodiscard]] SolvedLink& link_of(int e) { return links[measurements[e].link]; }
  [[nodiscard]] Verdict verdict(int e) const { return links[measurements[e].link].link.result.verdict; }
  [[nodiscard]] std::vector<int> with_verdict(Verdict v) const {
    std::vector<int> out;
    for (int e = 0; e < static_cast<int>(measurements.size()); ++e)
      if (verdict(e) == v) out.push_back(e);
    return out;
  }
  void judge(int e, Verdict verdict, std::string reason) {
    link_of(e).link.result.verdict = verdict;
    link_of(e).link.result.reason = std::move(reason);
  }
};

std::string name_of(const GraphScan& scan) { return scan.name.empty() ? std::to_string(scan.id) : scan.name; }

std::string loop_text(const Solver& s, const std::vector<int>& nodes) {
  std::string text;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const bool left_out =
        nodes.size() > kMaxNamedScans && k >= kMaxNamedScans / 2 && k + kMaxNamedScans / 2 < nodes.size();
    if (left_out && k != kMaxNamedScans / 2) continue;
    if (k > 0) text += " - ";
    text += left_out ? fmt::format("({} more)", nodes.size() - kMaxNamedScans) : name_of(s.scans[nodes[k]]);
  }
  return text;
}

std::string error_text(double rotation_rad, double translation_m) {
  return fmt::format("{:.2f} deg, {:.3g} m", deg(rotation_rad), translation_m);
}

/// Content order, so that the order in which links arrive cannot show.
bool link_less(const SolvedLink& a, const SolvedLink& b) {
  const auto key = [](const SolvedLink& l) {
    return std::tuple(l.link.source, l.link.target, l.link.guided, -l.link.result.probability,
                      l.link.result.target_from_source.has_value());
  };
  if (key(a) != key(b)) return key(a) < key(b);
  if (!a.link.result.target_from_source) return false;
  const auto& x = a.link.result.target_from_source->matrix();
  const auto& y = b.link.result.target_from_source->matrix();
  return std::lexicographical_compare(x.data(), x.data() + x.size(), y.data(), y.data() + y.size());
}

Solver prepared(const PoseGraph& graph, const SolveOptions& options) {
  Solver s{options, graph.voxel_m, graph.scans, {}, {}, {}, {}, {}};
  std::sort(s.scans.begin(), s.scans.end(), [](const GraphScan& a, const GraphScan& b) { return a.id < b.id; });
  std::map<int, int> node_of_id;
  for (int i = 0; i < s.num_nodes(); ++i) node_of_id.emplace(s.scans[i].id, i);
  for (const Link& link : graph.links)
    s.links.push_back({link, link.result.verdict, {}, {}, false, link.result.probability});
  std::stable_sort(s.links.begin(), s.links.end(), link_less);
  for (std::size_t k = 0; k < s.links.size(); ++k) {
    PairResult& r = s.links[k].link.result;
    if (!s.links[k].link.refuted.empty()) {
      r.verdict = Verdict::rejected;
      r.reason = s.links[k].link.refuted;
      continue;
    }
    if (r.verdict != Verdict::accepted && r.verdict != Verdict::ambiguous) continue;
    if (r.verdict == Verdict::ambiguous && !r.target_from_source) continue;
    const auto source = node_of_id.find(s.links[k].link.source), target = node_of_id.find(s.links[k].link.target);
    MeasurementOrReason m;
    if (source == node_of_id.end() || target == node_of_id.end() || source == target)
      m.reason = "does not join two scans of this survey";
    else
      m = measurement_of(s.links[k].link, s.scans[source->second], s.scans[target->second],
                         noise_model(graph, s.scans[source->second], options));
    if (!m.reason.empty()) {
      r.verdict = Verdict::failed;
      r.reason = "the link cannot be used: " + m.reason;
      continue;
    }
    m.measurement.link = static_cast<int>(k);
    m.measurement.source = source->second;
    m.measurement.target = target->second;
    s.measurements.push_back(m.measurement);
  }
  return s;
}

std::string list_of_links(const Solver& s, const std::vector<int>& edges) {
  std::string text;
  for (const int e : edges)
    text += fmt::format("{}{} - {}", text.empty() ? "" : ", ", name_of(s.scans[s.measurements[e].source]),
                        name_of(s.scans[s.measurements[e].target]));
  return text;
}

void promote(Solver& s, int e, const std::string& why) {
  s.judge(e, Verdict::accepted, fmt::format("{} (by itself ambiguous: {})", why, s.link_of(e).link.result.reason));
}

void let_links_judge_each_other(Solver& s) {
  Consensus consensus = find_consensus(s.num_nodes(), s.measurements, s.options);
  s.tree = std::move(consensus.tree);
  for (const LoopRejection& r : consensus.rejections) {
    const std::string loop = loop_text(s, r.error.loop);
    const std::string error = error_text(r.error.rotation_rad, r.error.translation_m);
    s.judge(r.measurement, Verdict::rejected,
            r.undecided ? fmt::format("the loop {} misses by {}, and nothing else tells which of its links is wrong",
                                      loop, error)
                        : fmt::format("disagrees with the loop {} by {}", loop, error));
    if (r.undecided)
      s.warnings.push_back(fmt::format("the loop {} misses by {}: its least certain links were rejected", loop, error));
  }
  for (const Promotion& p : consensus.promotions)
    promote(s, p.measurement, "agrees with " + list_of_links(s, p.confirmed_by));
}

/// Spanning forest of the accepted links: the tree that the loops chose, completed by probable links.
std::vector<int> spanning(const Solver& s) {
  std::vector<int> order;
  for (const int e : s.tree)
    if (s.verdict(e) == Verdict::accepted) order.push_back(e);
  std::vector<int> rest = s.with_verdict(Verdict::accepted);
  std::erase_if(rest, [&](int e) { return std::binary_search(s.tree.begin(), s.tree.end(), e); });
  std::stable_sort(rest.begin(), rest.end(),
                   [&](int a, int b) { return s.measurements[a].log_odds > s.measurements[b].log_odds; });
  order.insert(order.end(), rest.begin(), rest.end());
  return spanning_edges(s.num_nodes(), s.measurements, order);
}

/// Node of each part's anchor: most accepted links, then the smallest id. Keyed by the part's root.
std::map<int, int> anchors_of(const Solver& s, const SpanningForest& forest) {
  std::vector<int> degree(s.scans.size(), 0);
  for (const int e : s.with_verdict(Verdict::accepted))
    ++degree[s.measurements[e].source], ++degree[s.measurements[e].target];
  std::map<int, int> anchors;
  for (int node = 0; node < s.num_nodes(); ++node) {
    const auto [at, first] = anchors.try_emplace(forest.root[node], node);
    if (!first && degree[node] > degree[at->second]) at->second = node;
  }
  return anchors;
}

std::vector<int> values_of(const std::map<int, int>& map) {
  std::vector<int> values;
  for (const auto& [key, value] : map) values.push_back(value);
  return values;
}

std::vector<char> accepted_mask(const Solver& s) {
  std::vector<char> mask;
  for (int e = 0; e < static_cast<int>(s.measurements.size()); ++e) mask.push_back(s.verdict(e) == Verdict::accepted);
  return mask;
}

/// Why the robust optimiser dropped a link: the shortest loop among the remaining ones, or the solved poses.
std::string outlier_reason(const Solver& s, int e) {
  const Measurement& m = s.measurements[e];
  const std::vector<int> path = shortest_path(s.num_nodes(), s.measurements, accepted_mask(s), m.source, m.target);
  const Vector6d d =
      disagreement(m.target_from_source.b_from_a, s.root_from_node[m.target].inverse() * s.root_from_node[m.source]);
  const std::string error = error_text(d.tail<3>().norm(), d.head<3>().norm());
  if (path.empty()) return "disagrees with the solved poses by " + error;
  return fmt::format("disagrees with the loop {} by {}", loop_text(s, nodes_of_path(s.measurements, path, m.source)),
                     error);
}

/// Optimises the accepted links; true if none was found to be an outlier.
bool optimise_once(Solver& s) {
  const SpanningForest forest = forest_of(s.num_nodes(), s.measurements, spanning(s));
  const std::vector<int> accepted = s.with_verdict(Verdict::accepted);
  std::vector<Measurement> subset;
  for (const int e : accepted) subset.push_back(s.measurements[e]);
  const OptimisedPoses solved =
      optimise(forest.root_from_node, subset, values_of(anchors_of(s, forest)), s.options.agreement_chi2);
  s.root_from_node = solved.root_from_node;
  if (!solved.problem.empty()) s.warnings.push_back("pose optimisation: " + solved.problem);
  std::vector<int> outliers;
  for (std::size_t k = 0; k < accepted.size(); ++k)
    if (solved.weights[k] == 0) outliers.push_back(accepted[k]);
  for (const int e : outliers) s.judge(e, Verdict::rejected, "");
  for (const int e : outliers) s.judge(e, Verdict::rejected, outlier_reason(s, e));
  return outliers.empty();
}

/// Accepts ambiguous links that the poses confirm; true if any was.
bool promote_confirmed(Solver& s) {
  if (!s.options.promote_ambiguous) return false;
  std::vector<int> kept;  // rejected and failed measurements take no part
  std::vector<Measurement> subset;
  SolvedParts parts;
  for (int e = 0; e < static_cast<int>(s.measurements.size()); ++e) {
    if (s.verdict(e) != Verdict::accepted && s.verdict(e) != Verdict::ambiguous) continue;
    kept.push_back(e);
    subset.push_back(s.measurements[e]);
    parts.believed.push_back(s.verdict(e) == Verdict::accepted);
  }
  parts.num_nodes = s.num_nodes();
  parts.measurements = subset;
  parts.root_from_node = s.root_from_node;
  parts.part = forest_of(s.num_nodes(), s.measurements, spanning(s)).root;
  const std::vector<ConfirmedLink> confirmed = confirmed_within_parts(parts, s.options);
  for (const ConfirmedLink& c : confirmed) {
    const Measurement& m = subset[c.measurement];
    promote(s, kept[c.measurement], "agrees with the loop " + loop_text(s, nodes_of_path(subset, c.path, m.source)));
  }
  return !confirmed.empty();
}

LinkError error_at(const Measurement& m, const std::vector<Transform>& root_from_node) {
  const Vector6d d =
      disagreement(m.target_from_source.b_from_a, root_from_node[m.target].inverse() * root_from_node[m.source]);
  return {d.tail<3>().norm(), d.head<3>().norm(), chi2_at(m, root_from_node)};
}

/// Accepted links that lie on a loop of links that were not told where to look.
void mark_loops(Solver& s) {
  std::vector<int> voters = s.with_verdict(Verdict::accepted);
  std::erase_if(voters, [&](int e) { return !s.measurements[e].votes; });
  const std::vector<int> tree = spanning_edges(s.num_nodes(), s.measurements, voters);
  const SpanningForest forest = forest_of(s.num_nodes(), s.measurements, tree);
  for (const int e : voters) {
    if (std::binary_search(tree.begin(), tree.end(), e)) continue;
    s.link_of(e).in_loop = true;
    for (const int t : tree_path(forest, s.measurements[e].source, s.measurements[e].target))
      s.link_of(t).in_loop = true;
  }
  for (const int e : voters)
    if (s.link_of(e).in_loop)
      s.link_of(e).probability = 1.0 / (1.0 + std::exp(-agreeing_vote(s.measurements[e], s.options)));
}

void record_errors(Solver& s, const SpanningForest& forest) {
  for (int e = 0; e < static_cast<int>(s.measurements.size()); ++e) {
    const Measurement& m = s.measurements[e];
    if (forest.root[m.source] != forest.root[m.target]) continue;
    s.link_of(e).before = error_at(m, forest.root_from_node);
    s.link_of(e).after = error_at(m, s.root_from_node);
  }
}

std::vector<Component> components_of(const Solver& s, const SpanningForest& forest, const std::map<int, int>& anchors) {
  std::map<int, Component> by_root;
  for (int node = 0; node < s.num_nodes(); ++node) by_root[forest.root[node]].scans.push_back(s.scans[node].id);
  std::vector<Component> components;
  for (auto& [root, component] : by_root) {
    component.anchor = s.scans[anchors.at(root)].id;
    components.push_back(std::move(component));
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const Component& a, const Component& b) { return a.scans.size() > b.scans.size(); });
  return components;
}

/// Back from centred frames to local ones, and from the tree's root to the anchor.
std::vector<PlacedScan> placed_scans(const Solver& s, const SpanningForest& forest, const std::map<int, int>& anchors,
                                     const std::vector<Component>& components) {
  std::vector<Measurement> accepted;
  for (const int e : s.with_verdict(Verdict::accepted)) accepted.push_back(s.measurements[e]);
  std::vector<std::optional<PoseSigma>> sigmas(s.scans.size());
  if (s.scans.size() <= kMaxScansForSigmas) sigmas = pose_sigmas(s.root_from_node, accepted, values_of(anchors));
  std::map<int, int> component_of_id;
  for (std::size_t c = 0; c < components.size(); ++c)
    for (const int id : components[c].scans) component_of_id[id] = static_cast<int>(c);
  std::vector<PlacedScan> out;
  for (int node = 0; node < s.num_nodes(); ++node) {
    const int anchor = anchors.at(forest.root[node]);
    PlacedScan placed{s.scans[node].id, component_of_id.at(s.scans[node].id), Transform::Identity(), {}, {}};
    if (node != anchor) {
      const Transform anchor_from_node = s.root_from_node[anchor].inverse() * s.root_from_node[node];
      placed.component_from_local = orthonormalised(Eigen::Translation3d(s.scans[anchor].centre) * anchor_from_node *
                                                    Eigen::Translation3d(-s.scans[node].centre));
    }
    if (sigmas[node]) placed.sigma_m = sigmas[node]->translation_m, placed.sigma_rad = sigmas[node]->rotation_rad;
    out.push_back(placed);
  }
  return out;
}

}  // namespace

const PlacedScan* Solution::find(int id) const {
  const auto at =
      std::lower_bound(scans.begin(), scans.end(), id, [](const PlacedScan& s, int key) { return s.id < key; });
  return at != scans.end() && at->id == id ? &*at : nullptr;
}

std::optional<Transform> predicted_target_from_source(const Solution& solution, int source, int target) {
  const PlacedScan* const s = solution.find(source);
  const PlacedScan* const t = solution.find(target);
  if (s == nullptr || t == nullptr || s->component != t->component) return std::nullopt;
  return orthonormalised(t->component_from_local.inverse() * s->component_from_local);
}

Solution solve(const PoseGraph& graph, const SolveOptions& options) {
  Solver s = prepared(graph, options);
  let_links_judge_each_other(s);
  // Ends: every turn moves at least one link from ambiguous to accepted or from accepted to rejected, never back.
  do {
    while (!optimise_once(s)) {
    }
  } while (promote_confirmed(s));
  const SpanningForest forest = forest_of(s.num_nodes(), s.measurements, spanning(s));
  const std::map<int, int> anchors = anchors_of(s, forest);
  record_errors(s, forest);
  mark_loops(s);
  Solution solution;
  solution.components = components_of(s, forest, anchors);
  solution.scans = placed_scans(s, forest, anchors, solution.components);
  solution.links = std::move(s.links);
  solution.warnings = std::move(s.warnings);
  std::sort(solution.warnings.begin(), solution.warnings.end());
  solution.warnings.erase(std::unique(solution.warnings.begin(), solution.warnings.end()), solution.warnings.end());
  return solution;
}

}  // namespace isthmus
