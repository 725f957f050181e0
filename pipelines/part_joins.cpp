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

std::map<int, int> link_distances(const Solution& solution, int from,
                                  const std::function<bool(const SolvedLink&)>& counts) {
  std::map<int, std::vector<int>> neighbours;
  for (const SolvedLink& l : solution.links) {
    if (!counts(l)) continue;
    neighbours[l.link.source].push_back(l.link.target);
    neighbours[l.link.target].push_back(l.link.source);
  }
  std::map<int, int> distance{{from, 0}};
  std::vector<int> front{from};
  while (!front.empty()) {
    std::vector<int> next;
    for (const int a : front) {
      const auto of_a = neighbours.find(a);
      if (of_a == neighbours.end()) continue;
      for (const int b : of_a->second)
        if (distance.try_emplace(b, distance[a] + 1).second) next.push_back(b);
    }
    front = std::move(next);
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
    joins[k].across = pairs_across(link_distances(solution, link.source, believed),
                                   link_distances(solution, link.target, believed), summaries, posing);
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
