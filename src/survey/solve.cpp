#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "survey/consensus.h"
#include "survey/control_fit.h"
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
// Fewer links that loops could judge tell nothing about the others.
constexpr double kFewestJudged = 8;
constexpr double kFittedShare = 0.5;  // of the pairs that the pair stage's probability was fitted on, those that fit
// A loop named in a reason lists at most this many scans.
constexpr std::size_t kMaxNamedScans = 8;

constexpr double deg(double rad) { return rad * 180.0 / std::numbers::pi; }

/// Everything the steps share. Nodes are positions in `scans`, which is sorted by id.
struct Solver {
  SolveOptions options;
  double voxel_m;
  std::vector<GraphScan> scans;
  std::vector<SolvedLink> links;          // sorted
  std::vector<Measurement> measurements;  // of links measured accepted or ambiguous
  std::vector<int> tree;                  // measurements that most loops agree with, ascending
  std::vector<Transform> root_from_node;  // solved, centred frames
  std::vector<char> undecided;            // per measurement: rejected with others, any of which may be the wrong one
  std::vector<char> doubted;              // per measurement: not believed because no loop could judge it
  std::vector<std::string> warnings;
  bool solid = true;     // Consensus::solid
  std::string distrust;  // why no link was believed on the pair stage's word; empty if links were

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
    return std::tuple(l.link.source, l.link.target, l.link.by_hand, l.link.guided, -l.link.result.probability,
                      l.link.result.target_from_source.has_value());
  };
  if (key(a) != key(b)) return key(a) < key(b);
  if (!a.link.result.target_from_source) return false;
  const auto& x = a.link.result.target_from_source->matrix();
  const auto& y = b.link.result.target_from_source->matrix();
  return std::lexicographical_compare(x.data(), x.data() + x.size(), y.data(), y.data() + y.size());
}

/// d_centred = Ad(-centre) d_local
Matrix6d information_in_local(const Measurement& m, const GraphScan& source) {
  const Matrix6d whitened = m.sqrt_information * adjoint(Transform(Eigen::Translation3d(-source.centre)));
  return whitened.transpose() * whitened;
}

/// Why others accept a link, and what the pair stage said of it.
std::string reason_beside_its_own(const std::string& why, Verdict measured, const std::string& own) {
  return fmt::format("{} (by itself {}: {})", why, to_string(measured), own);
}

Solver prepared(const PoseGraph& graph, const SolveOptions& options) {
  Solver s{options, graph.voxel_m, graph.scans, {}, {}, {}, {}, {}, {}, {}, true, {}};
  std::sort(s.scans.begin(), s.scans.end(), [](const GraphScan& a, const GraphScan& b) { return a.id < b.id; });
  std::map<int, int> node_of_id;
  for (int i = 0; i < s.num_nodes(); ++i) node_of_id.emplace(s.scans[i].id, i);
  for (const Link& link : graph.links)
    s.links.push_back({link, link.result.verdict, {}, {}, false, link.result.probability, Matrix6d::Zero()});
  std::stable_sort(s.links.begin(), s.links.end(), link_less);
  for (std::size_t k = 0; k < s.links.size(); ++k) {
    PairResult& r = s.links[k].link.result;
    if (s.links[k].link.by_hand == ByHand::taken_out) {
      r.verdict = Verdict::rejected;
      r.reason = fmt::format("taken out by hand ({} before: {})", to_string(s.links[k].measured), r.reason);
      continue;
    }
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
    if (r.verdict == Verdict::ambiguous && !s.links[k].link.confirmed.empty()) {
      r.reason = reason_beside_its_own(s.links[k].link.confirmed, r.verdict, r.reason);
      r.verdict = Verdict::accepted;
      m.measurement.accepted = true;
      m.measurement.log_odds = clipped_log_odds(s.links[k].link.confirmed_probability);
      s.links[k].probability = s.links[k].link.confirmed_probability;
    }
    m.measurement.link = static_cast<int>(k);
    m.measurement.source = source->second;
    m.measurement.target = target->second;
    s.links[k].information_used = information_in_local(m.measurement, s.scans[source->second]);
    s.measurements.push_back(m.measurement);
    s.undecided.push_back(0);
    s.doubted.push_back(0);
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
  const SolvedLink& link = s.link_of(e);
  s.judge(e, Verdict::accepted, reason_beside_its_own(why, link.measured, link.link.result.reason));
}

void let_links_judge_each_other(Solver& s) {
  Consensus consensus = find_consensus(s.num_nodes(), s.measurements, s.options);
  s.tree = std::move(consensus.tree);
  s.solid = consensus.solid;
  for (const LoopRejection& r : consensus.rejections) {
    const std::string loop = loop_text(s, r.error.loop);
    const std::string error = error_text(r.error.rotation_rad, r.error.translation_m);
    s.judge(r.measurement, Verdict::rejected,
            r.undecided ? fmt::format("the loop {} misses by {}, and nothing else tells which of its links is wrong",
                                      loop, error)
                        : fmt::format("disagrees with the loop {} by {}", loop, error));
    s.undecided[r.measurement] = r.undecided;
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

/// Why a link was dropped: the shortest loop among the remaining ones, or the solved poses.
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
    if (s.doubted[e]) continue;  // who could confirm it had been asked before
    kept.push_back(e);
    subset.push_back(s.measurements[e]);
    parts.believed.push_back(s.verdict(e) == Verdict::accepted);
  }
  parts.num_nodes = s.num_nodes();
  parts.measurements = subset;
  parts.root_from_node = s.root_from_node;
  parts.part = forest_of(s.num_nodes(), s.measurements, spanning(s)).root;
  SolveOptions within = s.options;  // what agrees with poses that stand bends nothing
  if (!s.distrust.empty()) within.chance_closure = SolveOptions().chance_closure;
  const std::vector<ConfirmedLink> confirmed = confirmed_within_parts(parts, within);
  for (const ConfirmedLink& c : confirmed) {
    const Measurement& m = subset[c.measurement];
    promote(s, kept[c.measurement], "agrees with the loop " + loop_text(s, nodes_of_path(subset, c.path, m.source)));
  }
  return !confirmed.empty();
}

/// What the loops say about the pair stage in this survey: of the accepted links that they could judge, the share that
/// was wrong, and the share that the pair stage's probabilities made expect.
struct TrackRecord {
  double wrong = 0, expected = 0, judged = 0;
};

TrackRecord track_record(const Solver& s, const std::vector<char>& in_loop) {
  // A survey without loops tells nothing: this many links that went as expected are assumed beforehand.
  constexpr double kPrior = 4, kUndecidedWrong = 0.5;
  TrackRecord record;
  double expected = 0;
  for (int e = 0; e < static_cast<int>(s.measurements.size()); ++e) {
    const Measurement& m = s.measurements[e];
    if (!m.accepted || !m.votes || s.doubted[e]) continue;
    const bool refuted = s.verdict(e) == Verdict::rejected;
    if (!refuted && !in_loop[e]) continue;
    // Of links that contradict each other and went together, some were right.
    record.wrong += !refuted ? 0.0 : s.undecided[e] ? kUndecidedWrong : 1.0;
    expected += 1.0 / (1.0 + std::exp(m.log_odds));
    ++record.judged;
  }
  const double share = record.judged > 0 ? expected / record.judged : 0;
  record.wrong = (record.wrong + kPrior * share) / (record.judged + kPrior);
  record.expected = share;
  return record;
}

/// Accepted links that have a vote: those that were told where to look and those that free space doubts have none.
std::vector<int> accepted_voters(const Solver& s) {
  std::vector<int> voters = s.with_verdict(Verdict::accepted);
  std::erase_if(voters, [&](int e) { return !s.measurements[e].votes; });
  return voters;
}

/// Links on a loop of `links`.
std::vector<char> on_loops(const Solver& s, const std::vector<int>& links) {
  const std::vector<int> tree = spanning_edges(s.num_nodes(), s.measurements, links);
  const SpanningForest forest = forest_of(s.num_nodes(), s.measurements, tree);
  std::vector<char> in_loop(s.measurements.size(), 0);
  for (const int e : links) {
    if (std::binary_search(tree.begin(), tree.end(), e)) continue;
    in_loop[e] = 1;
    for (const int t : tree_path(forest, s.measurements[e].source, s.measurements[e].target)) in_loop[t] = 1;
  }
  return in_loop;
}

/// A link that no loop confirms is worth what the pair stage's word is worth in this survey: where loops refute many
/// of the links that they can judge, one more that they cannot judge joins nothing. True if any was taken out.
bool doubt_bridges(Solver& s) {
  const std::vector<int> voters = accepted_voters(s);
  const std::vector<char> in_loop = on_loops(s, voters);
  const TrackRecord record = track_record(s, in_loop);
  if (record.judged < kFewestJudged || record.wrong <= record.expected) return false;
  const double scale = std::log((1 - record.wrong) / record.wrong) - std::log((1 - record.expected) / record.expected);
  const SpanningForest parts =
      forest_of(s.num_nodes(), s.measurements, spanning_edges(s.num_nodes(), s.measurements, voters));
  bool any = false;
  for (const int e : s.with_verdict(Verdict::accepted)) {
    if (in_loop[e] || s.link_of(e).link.by_hand == ByHand::added) continue;
    const Measurement& m = s.measurements[e];
    if (!m.votes && parts.root[m.source] == parts.root[m.target]) continue;  // it joins nothing
    const double probability = std::min(1 - record.wrong, probability_of(m.log_odds + scale));
    if (probability >= 1.0 - s.options.undecided_wrong_probability) continue;
    s.judge(
        e, Verdict::rejected,
        fmt::format("no loop confirms it, and loops refute {:.0f} % of this survey's links that they can judge: right "
                    "with {:.2f}, too little to join anything (by itself: {})",
                    100 * record.wrong, probability, s.link_of(e).link.result.reason));
    s.link_of(e).probability = probability;
    s.doubted[e] = 1;
    any = true;
  }
  if (any)
    s.warnings.push_back(
        fmt::format("loops refute {:.0f} % of the accepted links that they can judge: links that no loop confirms were "
                    "not believed",
                    100 * record.wrong));
  return any;
}

/// The share of the tried pairs that fit, links that wait for a witness included.
double share_that_fits(const Solver& s) {
  constexpr double kPrior = 10;
  double tried = kPrior, fit = kPrior * kFittedShare;
  for (const SolvedLink& l : s.links) {
    if (l.link.guided || l.link.by_hand != ByHand::nothing) continue;
    const Verdict verdict = l.link.result.verdict;
    ++tried;
    fit += verdict == Verdict::accepted || (verdict == Verdict::ambiguous && l.measured == Verdict::accepted);
  }
  return fit / tried;
}

/// The pair stage's probabilities hold where half of the pairs that are tried fit, as on the sets they were fitted on.
/// Of a large survey's pairs one in five to one in ten does: as many more wrong ones had their chance. An accepted link
/// that no loop confirms and that is less than likely at this survey's own share waits for a witness, and so do the
/// links that were found by following it. True if any was.
bool await_witnesses(Solver& s) {
  constexpr double kLeastProbability = 0.9;
  const double share = share_that_fits(s);
  if (share >= kFittedShare) return false;
  const double scale = std::log(share / (1 - share)) - std::log(kFittedShare / (1 - kFittedShare));
  const std::vector<char> in_loop = on_loops(s, accepted_voters(s));
  std::vector<int> found_alone = s.with_verdict(Verdict::accepted);
  std::erase_if(found_alone, [&](int e) { return s.link_of(e).link.guided; });
  const SpanningForest parts =
      forest_of(s.num_nodes(), s.measurements, spanning_edges(s.num_nodes(), s.measurements, found_alone));
  bool any = false;
  for (const int e : s.with_verdict(Verdict::accepted)) {
    const Measurement& m = s.measurements[e];
    const Link& link = s.link_of(e).link;
    if (in_loop[e] || s.doubted[e] || link.by_hand == ByHand::added || !link.confirmed.empty()) continue;
    if (link.guided && parts.root[m.source] == parts.root[m.target]) continue;  // it joins nothing
    const double probability = probability_of(m.log_odds + scale);
    if (probability >= kLeastProbability) continue;
    s.judge(
        e, Verdict::ambiguous,
        fmt::format("no loop confirms it, and only {:.0f} % of the pairs tried fit: right with {:.2f} (by itself: {})",
                    100 * share, probability, link.result.reason));
    s.link_of(e).probability = probability;
    s.doubted[e] = 1;
    any = true;
  }
  return any;
}

/// How often refuted links agree with each other: the chance with which a wrong link finds a witness in this survey.
double closure_of_refuted(const Solver& s) {
  constexpr double kPrior = 4;
  const std::vector<int> part = forest_of(s.num_nodes(), s.measurements, spanning(s)).root;
  std::vector<int> refuted;
  for (const int e : s.with_verdict(Verdict::rejected))
    if (s.measurements[e].accepted && s.measurements[e].votes) refuted.push_back(e);
  const auto step = [&](int from, int to) { return s.root_from_node[to].inverse() * s.root_from_node[from]; };
  int agreeing = 0;
  for (const int e : refuted) {
    const Measurement& m = s.measurements[e];
    agreeing += std::any_of(refuted.begin(), refuted.end(), [&](int other) {
      const Measurement& o = s.measurements[other];
      if (other == e) return false;
      for (const auto& [near, far] : {std::pair(o.source, o.target), std::pair(o.target, o.source)}) {
        if (part[near] != part[m.source] || part[far] != part[m.target]) continue;
        const Transform predicted = step(far, m.target) * walked_from(o, near).b_from_a * step(m.source, near);
        if (is_tight(disagreement(m.target_from_source.b_from_a, predicted), m)) return true;
      }
      return false;
    });
  }
  return (agreeing + kPrior * s.options.chance_closure) / (static_cast<double>(refuted.size()) + kPrior);
}

/// Where loops refute so many accepted links that the pair stage's word is worth little, nothing is believed on that
/// word alone: every link becomes ambiguous, as probable as the share that stood, and agreement is worth what it is
/// worth among the refuted. Links taken out or added by hand stay. True if it came to that.
bool distrust_all(Solver& s, const PoseGraph& graph, const SolveOptions& options) {
  const TrackRecord record = track_record(s, on_loops(s, accepted_voters(s)));
  if (record.judged < kFewestJudged ||
      record.wrong < std::max(options.undecided_wrong_probability, 2 * record.expected))
    return false;
  const double closure = std::max(options.chance_closure, std::min(0.5, closure_of_refuted(s)));
  Solver anew = prepared(graph, options);
  anew.distrust = fmt::format("loops refute {:.0f} % of the accepted links that they can judge", 100 * record.wrong);
  anew.options.chance_closure = closure;
  for (int e = 0; e < static_cast<int>(anew.measurements.size()); ++e) {
    Measurement& m = anew.measurements[e];
    if (anew.link_of(e).link.by_hand != ByHand::nothing) continue;
    m.log_odds = std::min(m.log_odds, clipped_log_odds(1 - record.wrong));
    if (m.accepted) anew.link_of(e).link.result.verdict = Verdict::ambiguous;
    m.doubted = m.accepted;
    m.accepted = false;
  }
  anew.warnings.push_back(anew.distrust + ": only links that enough others confirm were believed");
  s = std::move(anew);
  return true;
}

void solve_links(Solver& s) {
  let_links_judge_each_other(s);
  // Ends: every turn moves at least one link from ambiguous to accepted or from accepted to rejected, never back; the
  // few that go from accepted to ambiguous go once.
  do {
    while (!optimise_once(s)) {
    }
  } while (promote_confirmed(s) || doubt_bridges(s) || await_witnesses(s));
}

/// Poses of the links that are believed, each weighing by what it knows. Which links are believed was judged with the
/// wide noise floor, which makes all nearly equal: good for judging, wasteful for placing.
void weigh_by_precision(Solver& s) {
  const SpanningForest forest = forest_of(s.num_nodes(), s.measurements, spanning(s));
  const std::vector<int> accepted = s.with_verdict(Verdict::accepted);
  std::vector<Measurement> believed;
  for (const int e : accepted) believed.push_back(s.measurements[e]);
  const OptimisedPoses solved = optimise_by_precision(s.root_from_node, believed, values_of(anchors_of(s, forest)));
  s.root_from_node = solved.root_from_node;
  if (!solved.problem.empty()) s.warnings.push_back("pose optimisation: " + solved.problem);
  for (std::size_t k = 0; k < believed.size(); ++k) {
    Measurement& m = believed[k];
    m.sqrt_information = std::sqrt(solved.weights[k]) * m.own_sqrt_information;
    // A link that fits better than others is not better known than the factor says.
    const double proven = std::min(solved.weights[k], 1.0 / solved.variance_factor);
    s.measurements[accepted[k]].proven_sqrt_information = std::sqrt(proven) * m.own_sqrt_information;
    s.links[m.link].information_used = information_in_local(m, s.scans[m.source]);
  }
}

/// Links that were believed for others' sake, within the wide noise: left open by the pair stage and confirmed by
/// loops, or found where the poses pointed. Seen from the precise poses, do they still meet? The one that misses most,
/// by more than a floor (half a voxel) in place or two in rotation, if loops hold what it joins; -1 if none does.
int loosest_follower(const Solver& s) {
  constexpr double kLooseFloors = 1, kLooseFloorsTurned = 2;
  const std::vector<char> in_loop = on_loops(s, s.with_verdict(Verdict::accepted));
  int loosest = -1;
  double most = 1;
  for (const int e : s.with_verdict(Verdict::accepted)) {
    const Measurement& m = s.measurements[e];
    const SolvedLink& link = s.links[m.link];
    const bool by_its_own_word = link.measured == Verdict::accepted && !link.link.guided;
    if (!in_loop[e] || by_its_own_word || link.link.by_hand == ByHand::added) continue;
    const Vector6d d =
        disagreement(m.target_from_source.b_from_a, s.root_from_node[m.target].inverse() * s.root_from_node[m.source]);
    const double missed = std::max(d.head<3>().norm() / (kLooseFloors * m.floor_m),
                                   d.tail<3>().norm() / (kLooseFloorsTurned * m.floor_rad));
    if (missed > most) most = missed, loosest = e;
  }
  return loosest;
}

void place_by_precision(Solver& s) {
  weigh_by_precision(s);
  for (int e = loosest_follower(s); e >= 0; e = loosest_follower(s)) {
    s.judge(e, Verdict::rejected, outlier_reason(s, e));
    s.links[s.measurements[e].link].information_used =
        information_in_local(s.measurements[e], s.scans[s.measurements[e].source]);
    weigh_by_precision(s);
  }
}

/// Links that the pair stage accepted, and that were not believed again after all were distrusted.
void reject_unconfirmed(Solver& s) {
  for (const int e : s.with_verdict(Verdict::ambiguous)) {
    if (s.link_of(e).measured != Verdict::accepted) continue;
    s.judge(e, Verdict::rejected,
            fmt::format("{}, and too few others confirm this one (by itself: {})", s.distrust,
                        s.link_of(e).link.result.reason));
  }
}

LinkError error_at(const Measurement& m, const std::vector<Transform>& root_from_node) {
  const Vector6d d =
      disagreement(m.target_from_source.b_from_a, root_from_node[m.target].inverse() * root_from_node[m.source]);
  return {d.tail<3>().norm(), d.head<3>().norm(), chi2_at(m, root_from_node)};
}

/// Accepted links that lie on a loop of links that were not told where to look.
void mark_loops(Solver& s) {
  const std::vector<char> in_loop = on_loops(s, accepted_voters(s));
  for (int e = 0; e < static_cast<int>(s.measurements.size()); ++e) {
    if (!in_loop[e]) continue;
    s.link_of(e).in_loop = true;
    s.link_of(e).probability = probability_of(agreeing_vote(s.measurements[e], s.options));
  }
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
  std::vector<Measurement> accepted;  // as stiff as they proved, not with the wide floor that links are judged with
  for (const int e : s.with_verdict(Verdict::accepted)) {
    accepted.push_back(s.measurements[e]);
    accepted.back().sqrt_information = accepted.back().proven_sqrt_information;
  }
  std::vector<std::optional<PoseSigma>> sigmas(s.scans.size());
  if (s.scans.size() <= kMaxScansForSigmas) sigmas = pose_sigmas(s.root_from_node, accepted, values_of(anchors));
  std::map<int, int> component_of_id;
  for (std::size_t c = 0; c < components.size(); ++c)
    for (const int id : components[c].scans) component_of_id[id] = static_cast<int>(c);
  std::vector<PlacedScan> out;
  for (int node = 0; node < s.num_nodes(); ++node) {
    const int anchor = anchors.at(forest.root[node]);
    PlacedScan placed;
    placed.id = s.scans[node].id;
    placed.component = component_of_id.at(placed.id);
    if (node != anchor) {
      const Transform anchor_from_node = s.root_from_node[anchor].inverse() * s.root_from_node[node];
      placed.component_from_local = orthonormalised(Eigen::Translation3d(s.scans[anchor].centre) * anchor_from_node *
                                                    Eigen::Translation3d(-s.scans[node].centre));
    }
    if (sigmas[node]) {
      placed.sigma_m = sigmas[node]->translation_m, placed.sigma_rad = sigmas[node]->rotation_rad;
      const std::optional<Georeference>& world = components[static_cast<std::size_t>(placed.component)].georeference;
      Matrix6d turn = Matrix6d::Zero();
      turn.topLeftCorner<3, 3>() = placed.component_from_local.linear();
      if (world) turn.topLeftCorner<3, 3>() = world->shifted_from_component.linear() * turn.topLeftCorner<3, 3>();
      turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
      placed.covariance = turn * sigmas[node]->covariance * turn.transpose();
    }
    out.push_back(placed);
  }
  return out;
}

/// World coordinates are large: a round number near their middle is taken off.
Eigen::Vector3d datum_shift(const Control& control) {
  constexpr double kRoundM = 100;
  std::vector<Eigen::Vector3d> known;
  for (const ControlPoint& p : control.points) known.push_back(p.p_in_world);
  for (const ControlPose& p : control.poses) known.push_back(p.world_from_local.translation());
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3 && !known.empty(); ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : known) values.push_back(p[axis]);
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    shift[axis] = std::round(values[values.size() / 2] / kRoundM) * kRoundM;
  }
  return shift;
}

/// Control about nodes; node -1: about a scan that the graph does not have.
std::vector<ControlTerm> terms_of(const Solver& s, const Control& control, const Eigen::Vector3d& shift,
                                  std::vector<ControlResult>& results) {
  std::vector<ControlTerm> terms;
  const auto add = [&](ControlKind kind, const std::string& name, int id) -> ControlTerm& {
    const auto scan = std::find_if(s.scans.begin(), s.scans.end(), [&](const GraphScan& g) { return g.id == id; });
    const bool known = scan != s.scans.end();
    results.push_back({kind,
                       known && name.empty() ? name_of(*scan) : name,
                       id,
                       false,
                       known ? "" : "its scan takes no part",
                       {},
                       {},
                       {},
                       {}});
    ControlTerm term;
    term.kind = kind;
    term.node = known ? static_cast<int>(scan - s.scans.begin()) : -1;
    return terms.emplace_back(term);
  };
  const auto centre = [&](int node) { return node < 0 ? Eigen::Vector3d::Zero().eval() : s.scans[node].centre; };
  for (const ControlPoint& p : control.points) {
    ControlTerm& term = add(ControlKind::point, p.name, p.scan);
    term.p_in_node = p.p_in_local - centre(term.node);
    term.p_in_shifted = p.p_in_world - shift;
    term.sigma_m = p.sigma_m;
  }
  for (const ControlPose& p : control.poses) {
    ControlTerm& term = add(ControlKind::pose, p.name, p.scan);
    term.shifted_from_node =
        Eigen::Translation3d(-shift) * p.world_from_local * Eigen::Translation3d(centre(term.node));
    term.sigma_m.setConstant(p.sigma_m);
    term.sigma_rad = p.sigma_rad;
  }
  for (const LevelledScan& l : control.levelled) add(ControlKind::levelled, "", l.scan).sigma_rad = l.sigma_rad;
  return terms;
}

void record_miss(const ControlTerm& term, const Transform& pose, std::optional<Eigen::Vector3d>& d_m,
                 std::optional<double>& angle) {
  const ControlMiss miss = miss_of(term, pose);
  if (term.kind != ControlKind::levelled) d_m = miss.d_m;
  if (term.kind != ControlKind::point) angle = miss.angle_rad;
}

/// Lays one component into the world; its poses become those of the shifted world.
std::optional<Georeference> georeference(Solver& s, const SpanningForest& forest, int root, int anchor,
                                         const std::vector<ControlTerm>& terms, const Eigen::Vector3d& shift,
                                         std::vector<ControlResult>& results) {
  ControlledPart part;
  part.anchor = anchor;
  for (int node = 0; node < s.num_nodes(); ++node)
    if (forest.root[node] == root) part.nodes.push_back(node);
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < terms.size(); ++k)
    if (terms[k].node >= 0 && forest.root[terms[k].node] == root) which.push_back(k), part.terms.push_back(terms[k]);
  if (part.terms.empty()) return std::nullopt;
  std::vector<Measurement> links;
  // The solved shape, as stiff as the wide noise floor makes it: control may bend it, links no longer pull at it.
  for (const int e : s.with_verdict(Verdict::accepted)) {
    if (forest.root[s.measurements[e].source] != root) continue;
    Measurement& m = links.emplace_back(s.measurements[e]);
    m.target_from_source.b_from_a = s.root_from_node[m.target].inverse() * s.root_from_node[m.source];
  }
  part.measurements = links;
  // The anchor's local frame is the root, so that a part that is only levelled stays where it is.
  const Transform rebased = Eigen::Translation3d(s.scans[anchor].centre) * s.root_from_node[anchor].inverse();
  for (const int node : part.nodes) s.root_from_node[node] = rebased * s.root_from_node[node];
  part.root_from_node = s.root_from_node;
  std::vector<double> sigma_m(s.scans.size(), 0), sigma_rad(s.scans.size(), 0);
  if (s.scans.size() <= kMaxScansForSigmas) {
    const auto sigmas = pose_sigmas(s.root_from_node, links, {anchor});
    for (std::size_t i = 0; i < sigmas.size(); ++i)
      if (sigmas[i]) sigma_m[i] = sigmas[i]->translation_m, sigma_rad[i] = sigmas[i]->rotation_rad;
  }
  part.sigma_m = sigma_m;
  part.sigma_rad = sigma_rad;
  const ControlFit fit = fit_control(part);
  for (std::size_t k = 0; k < which.size(); ++k) {
    ControlResult& result = results[which[k]];
    result.reason = fit.refused[k];
    result.used = fit.placed && result.reason.empty();
    if (!fit.placed) continue;
    const ControlTerm& term = part.terms[k];
    const auto at = std::find(part.nodes.begin(), part.nodes.end(), term.node) - part.nodes.begin();
    record_miss(term, fit.shifted_from_root * s.root_from_node[term.node], result.before, result.before_rad);
    record_miss(term, fit.shifted_from_node[static_cast<std::size_t>(at)], result.after, result.after_rad);
  }
  if (!fit.placed) {
    s.warnings.push_back(
        fmt::format("the part of {} is not placed in the world: {}", name_of(s.scans[anchor]), fit.problem));
    return std::nullopt;
  }
  for (std::size_t k = 0; k < part.nodes.size(); ++k) s.root_from_node[part.nodes[k]] = fit.shifted_from_node[k];
  Georeference out;
  if (!fit.levelled_only) out.shift_m = shift;
  out.shifted_from_component =
      orthonormalised(s.root_from_node[anchor] * Eigen::Translation3d(-s.scans[anchor].centre));
  out.levelled_only = fit.levelled_only;
  return out;
}

std::vector<ControlResult> lay_into_the_world(Solver& s, const SpanningForest& forest,
                                              const std::map<int, int>& anchors, const Control& control,
                                              std::map<int, Georeference>& by_anchor) {
  std::vector<ControlResult> results;
  const Eigen::Vector3d shift = datum_shift(control);
  const std::vector<ControlTerm> terms = terms_of(s, control, shift, results);
  for (const auto& [root, anchor] : anchors)
    if (const auto placed = georeference(s, forest, root, anchor, terms, shift, results))
      by_anchor[s.scans[anchor].id] = *placed;
  for (const ControlResult& r : results)
    if (!r.used && (r.before || r.before_rad))
      s.warnings.push_back(fmt::format("control {}: not used, {}", r.name, r.reason));
  return results;
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

Solution solve(const PoseGraph& graph, const SolveOptions& options, const Control& control) {
  Solver s = prepared(graph, options);
  solve_links(s);
  if (options.promote_ambiguous && !s.solid && distrust_all(s, graph, options)) {
    solve_links(s);
    reject_unconfirmed(s);
  }
  place_by_precision(s);
  const SpanningForest forest = forest_of(s.num_nodes(), s.measurements, spanning(s));
  const std::map<int, int> anchors = anchors_of(s, forest);
  Solution solution;
  std::map<int, Georeference> georeferences;  // by the anchor's id
  if (!control.empty()) solution.control = lay_into_the_world(s, forest, anchors, control, georeferences);
  record_errors(s, forest);
  mark_loops(s);
  solution.components = components_of(s, forest, anchors);
  for (Component& component : solution.components) {
    const auto at = georeferences.find(component.anchor);
    if (at != georeferences.end()) component.georeference = at->second;
  }
  solution.scans = placed_scans(s, forest, anchors, solution.components);
  solution.links = std::move(s.links);
  solution.warnings = std::move(s.warnings);
  std::sort(solution.warnings.begin(), solution.warnings.end());
  solution.warnings.erase(std::unique(solution.warnings.begin(), solution.warnings.end()), solution.warnings.end());
  return solution;
}

}  // namespace isthmus
