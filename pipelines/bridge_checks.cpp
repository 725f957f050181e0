#include "pipelines/bridge_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kWitnesses = 8;           // pairs across a link
constexpr double kLeastPredictedOverlap = 0.1;  // of a witness: what hardly meets says nothing
constexpr double kRefutingShare = 1.0 / 3;      // measured: none of 167 true pairs, 37 of 48 of a floor one room off

constexpr int kReach = 2;  // links from an end to a witness

struct Suspect {
  const SolvedLink* link = nullptr;
  std::vector<std::size_t> witnesses;  ///< into the list of pairs to check
};

bool believed(const SolvedLink& l) { return l.link.result.verdict == Verdict::accepted; }

using Neighbours = std::map<int, std::vector<int>>;

/// Links that were found without being told where to look.
Neighbours neighbours_without(const Solution& solution, const Link& left_out) {
  Neighbours out;
  for (const SolvedLink& l : solution.links) {
    if (!believed(l) || l.link.guided || &l.link == &left_out) continue;
    out[l.link.source].push_back(l.link.target);
    out[l.link.target].push_back(l.link.source);
  }
  return out;
}

/// Scans that hang together with `from`, and over how many links.
std::map<int, int> distances(const Neighbours& neighbours, int from) {
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

/// What lies on either side of a link that nothing else spans; absent for a link on a loop.
struct Sides {
  std::map<int, int> of_source, of_target;
};
std::optional<Sides> sides_of(const Solution& solution, const Link& link) {
  const Neighbours neighbours = neighbours_without(solution, link);
  Sides sides{distances(neighbours, link.source), {}};
  if (sides.of_source.contains(link.target)) return std::nullopt;
  sides.of_target = distances(neighbours, link.target);
  return sides;
}

/// Pairs near the link and across it, by predicted overlap; the link's own is left out.
std::vector<PosedPair> witnesses_of(const Solution& solution, const std::map<int, const ScanSummary*>& summaries,
                                    const Sides& sides) {
  std::vector<std::pair<double, PosedPair>> found;
  for (const auto& [a, to_a] : sides.of_source)
    for (const auto& [b, to_b] : sides.of_target) {
      if (to_a > kReach || to_b > kReach || (to_a == 0 && to_b == 0)) continue;
      const int source = std::max(a, b), target = std::min(a, b);
      const auto predicted = predicted_target_from_source(solution, source, target);
      if (!predicted || !summaries.contains(source) || !summaries.contains(target)) continue;
      const double overlap = predicted_overlap(*summaries.at(source), *summaries.at(target), *predicted);
      if (overlap >= kLeastPredictedOverlap) found.push_back({overlap, {source, target, *predicted}});
    }
  std::ranges::stable_sort(found, std::ranges::greater(), [](const auto& f) { return f.first; });
  if (found.size() > kWitnesses) found.resize(kWitnesses);
  std::vector<PosedPair> pairs;
  for (auto& [overlap, pair] : found) pairs.push_back(pair);
  return pairs;
}

std::string name_of(std::span<const OutlinedScan> scans, int id) {
  const auto at = std::ranges::lower_bound(scans, id, {}, &OutlinedScan::id);
  return at != scans.end() && at->id == id && !at->name.empty() ? at->name : std::to_string(id);
}

}  // namespace

std::vector<RefutedLink> refuted_bridge(const Solution& solution, std::span<const OutlinedScan> scans,
                                        const PoseChecker& check) {
  std::map<int, const ScanSummary*> summaries;
  for (const OutlinedScan& scan : scans) summaries[scan.id] = scan.summary;
  std::vector<PosedPair> pairs;
  std::map<std::pair<int, int>, std::size_t> known;
  std::vector<Suspect> suspects;
  for (const SolvedLink& solved : solution.links) {
    if (!believed(solved) || solved.in_loop) continue;
    const auto sides = sides_of(solution, solved.link);
    if (!sides) continue;
    Suspect suspect{&solved, {}};
    for (const PosedPair& pair : witnesses_of(solution, summaries, *sides)) {
      const auto [at, is_new] = known.try_emplace({pair.source, pair.target}, pairs.size());
      if (is_new) pairs.push_back(pair);
      suspect.witnesses.push_back(at->second);
    }
    if (!suspect.witnesses.empty()) suspects.push_back(std::move(suspect));
  }
  if (pairs.empty()) return {};
  const std::vector<std::optional<PoseCheck>> checks = check(pairs);
  double worst_share = 0;
  std::optional<RefutedLink> worst;
  const Suspect* accused = nullptr;
  for (const Suspect& suspect : suspects) {
    std::size_t num_checked = 0, num_forbidden = 0;
    std::size_t clearest = suspect.witnesses.front();
    for (const std::size_t k : suspect.witnesses) {
      if (!checks[k]) continue;
      ++num_checked;
      if (!checks[k]->forbidden()) continue;
      if (num_forbidden++ == 0 || checks[k]->contradiction > checks[clearest]->contradiction) clearest = k;
    }
    if (num_forbidden == 0) continue;
    const double share = static_cast<double>(num_forbidden) / static_cast<double>(num_checked);
    if (share < kRefutingShare || share <= worst_share) continue;
    worst_share = share;
    accused = &suspect;
    const Link& link = suspect.link->link;
    worst = RefutedLink{
        link.source, link.target,
        fmt::format("with it {} of {} pairs across it would stand where the other saw through, {} and {} with {:.0f} % "
                    "of their points",
                    num_forbidden, num_checked, name_of(scans, pairs[clearest].source),
                    name_of(scans, pairs[clearest].target), 100 * checks[clearest]->contradiction)};
  }
  if (accused == nullptr) return {};
  std::vector<RefutedLink> refuted{*worst};
  const auto sides = sides_of(solution, accused->link->link);
  for (const SolvedLink& l : solution.links) {
    if (!believed(l) || !l.link.guided || &l == accused->link) continue;
    const auto across = [&](int a, int b) { return sides->of_source.contains(a) && sides->of_target.contains(b); };
    if (!across(l.link.source, l.link.target) && !across(l.link.target, l.link.source)) continue;
    refuted.push_back({l.link.source, l.link.target,
                       fmt::format("found where {} - {} pointed, and {}", name_of(scans, worst->source),
                                   name_of(scans, worst->target), worst->reason)});
  }
  return refuted;
}

}  // namespace isthmus::pipelines
