#include "pipelines/part_joins.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace isthmus::pipelines {
namespace {

constexpr int kReach = 2;  // links from an end to a witness

}  // namespace

bool believed(const SolvedLink& link) { return link.link.result.verdict == Verdict::accepted; }

Summaries summaries_of(std::span<const OutlinedScan> scans) {
  Summaries summaries;
  for (const OutlinedScan& scan : scans) summaries[scan.id] = scan.summary;
  return summaries;
}

LinksOf links_of_scans(const Solution& solution, const std::function<bool(const SolvedLink&)>& counts) {
  LinksOf of;
  for (const SolvedLink& l : solution.links) {
    if (!counts(l)) continue;
    of[l.link.source].push_back(&l);
    of[l.link.target].push_back(&l);
  }
  return of;
}

int other_end(const SolvedLink& link, int scan) {
  return link.link.source == scan ? link.link.target : link.link.source;
}

std::map<int, int> link_distances(const LinksOf& links_of, std::vector<int> starts,
                                  const std::function<bool(int)>& barred) {
  std::map<int, int> distance;
  for (const int start : starts) distance.emplace(start, 0);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const int scan = starts[k];
    const auto links = links_of.find(scan);
    if (links == links_of.end()) continue;
    for (const SolvedLink* l : links->second) {
      const int next = other_end(*l, scan);
      if (barred && barred(next)) continue;
      if (distance.try_emplace(next, distance.at(scan) + 1).second) starts.push_back(next);
    }
  }
  return distance;
}

std::vector<GuidedPair> pairs_across(const std::map<int, int>& of_source, const std::map<int, int>& of_target,
                                     const Summaries& summaries, const Posing& posing) {
  std::vector<GuidedPair> found;
  for (const auto& [a, to_a] : of_source)
    for (const auto& [b, to_b] : of_target) {
      if (to_a > kReach || to_b > kReach || (to_a == 0 && to_b == 0)) continue;
      const int source = std::max(a, b), target = std::min(a, b);
      const auto posed = posing(source, target);
      if (!posed || !summaries.contains(source) || !summaries.contains(target)) continue;
      const double overlap = predicted_overlap(*summaries.at(source), *summaries.at(target), *posed);
      if (overlap >= kLeastPredictedOverlap) found.push_back({source, target, overlap, *posed});
    }
  std::ranges::stable_sort(found, std::ranges::greater(), &GuidedPair::predicted_overlap);
  return found;
}

namespace {

void find_pairs_across(std::vector<PartJoin>& joins, const Solution& solution, const Summaries& summaries) {
  const LinksOf links_of = links_of_scans(solution, believed);
  parallel_for_index(joins.size(), 1, [&](std::size_t k) {
    const Link& link = joins[k].link->link;
    const PlacedScan *source = solution.find(link.source), *target = solution.find(link.target);
    const Transform target_part_from_source_part =
        target->component_from_local * joins[k].target_from_source * source->component_from_local.inverse();
    const auto posing = [&](int a, int b) -> std::optional<Transform> {  // b_from_a
      const PlacedScan *from = solution.find(a), *to = solution.find(b);
      if (from == nullptr || to == nullptr) return std::nullopt;
      const Transform to_part_from_from_part =
          from->component == source->component ? target_part_from_source_part : target_part_from_source_part.inverse();
      return orthonormalised(to->component_from_local.inverse() * to_part_from_from_part * from->component_from_local);
    };
    joins[k].across = pairs_across(link_distances(links_of, {link.source}), link_distances(links_of, {link.target}),
                                   summaries, posing);
  });
}

double score_of(const PairResult& result) {
  const auto at = std::ranges::find(result.evidence, "score", &std::pair<std::string, double>::first);
  return at != result.evidence.end() ? at->second : 0;
}

std::vector<PartJoin> joins_by(const Solution& solution, const Summaries& summaries,
                               const std::function<bool(const SolvedLink&)>& admits) {
  std::vector<PartJoin> joins;
  for (const SolvedLink& solved : solution.links) {
    const PairResult& result = solved.link.result;
    const PlacedScan *source = solution.find(solved.link.source), *target = solution.find(solved.link.target);
    if (!admits(solved) || !result.target_from_source || source == nullptr || target == nullptr ||
        source->component == target->component)
      continue;
    joins.push_back({&solved, *result.target_from_source, score_of(result), {}});
  }
  find_pairs_across(joins, solution, summaries);
  return joins;
}

}  // namespace

std::vector<PartJoin> possible_joins(const Solution& solution, const Summaries& summaries) {
  return joins_by(solution, summaries, [](const SolvedLink& l) { return l.link.result.verdict == Verdict::ambiguous; });
}

std::vector<PartJoin> refuted_between_parts(const Solution& solution, const Summaries& summaries) {
  return joins_by(solution, summaries, [](const SolvedLink& l) {
    return !l.link.refuted.empty() && l.measured == Verdict::accepted && !l.link.guided;
  });
}

std::vector<PartJoin> rival_joins(std::span<const PartJoin> joins, const Solution& solution,
                                  const Summaries& summaries) {
  std::vector<PartJoin> rivals;
  for (const PartJoin& join : joins)
    for (const RivalPose& rival : join.link->link.result.rivals)
      rivals.push_back({join.link, rival.target_from_source, rival.score, {}});
  find_pairs_across(rivals, solution, summaries);
  return rivals;
}

}  // namespace isthmus::pipelines
