#include "pipelines/bridge_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "pairwise/judge.h"

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kWitnesses = 12;          // pairs across a link
constexpr double kLeastPredictedOverlap = 0.1;  // of a witness: what hardly meets says nothing
constexpr int kReach = 2;                       // links from an end to a witness

constexpr double kTellingSupport = 0.05;  // a pair that neither meets nor contradicts says nothing

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
  [[nodiscard]] bool separate(int a, int b) const {
    return (of_source.contains(a) && of_target.contains(b)) || (of_source.contains(b) && of_target.contains(a));
  }
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

struct Suspect {
  const SolvedLink* link = nullptr;
  Sides sides;
};

/// What the checked pairs across a suspect say, whoever called them.
struct Testimony {
  std::size_t num_telling = 0, num_forbidden = 0;
  std::size_t clearest = 0;  ///< the pair with the most contradiction
  /// Of 167 true pairs none was forbidden; of a floor one room off 37 of the 48 that meet, fewer where the rooms were
  /// chosen to fit. One forbidden pair alone may be a door or a van.
  [[nodiscard]] bool refutes() const {
    constexpr double kShareOfSeveral = 0.2, kShareOfOne = 0.5;
    const double share = num_telling > 0 ? static_cast<double>(num_forbidden) / static_cast<double>(num_telling) : 0.0;
    return share >= (num_forbidden > 1 ? kShareOfSeveral : kShareOfOne);
  }
};

Testimony testimony_against(const Suspect& suspect, std::span<const PosedPair> pairs,
                            std::span<const std::optional<PoseCheck>> checks) {
  Testimony said;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Link& link = suspect.link->link;
    const bool own = std::minmax(pairs[k].source, pairs[k].target) == std::minmax(link.source, link.target);
    if (!checks[k] || own || !suspect.sides.separate(pairs[k].source, pairs[k].target)) continue;
    const bool forbidden = checks[k]->forbidden();
    if (!forbidden && checks[k]->support < kTellingSupport) continue;
    ++said.num_telling;
    if (!forbidden) continue;
    if (said.num_forbidden++ == 0 || checks[k]->contradiction > checks[said.clearest]->contradiction) said.clearest = k;
  }
  return said;
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
  std::set<std::pair<int, int>> known;
  std::vector<Suspect> suspects;
  for (const SolvedLink& solved : solution.links) {
    if (!believed(solved) || solved.in_loop) continue;
    auto sides = sides_of(solution, solved.link);
    if (!sides) continue;
    for (const PosedPair& pair : witnesses_of(solution, summaries, *sides))
      if (known.emplace(pair.source, pair.target).second) pairs.push_back(pair);
    suspects.push_back({&solved, std::move(*sides)});
  }
  if (pairs.empty()) return {};
  const std::vector<std::optional<PoseCheck>> checks = check(pairs);
  const Suspect* accused = nullptr;
  Testimony worst;
  for (const Suspect& suspect : suspects) {
    const Testimony said = testimony_against(suspect, pairs, checks);
    if (!said.refutes()) continue;
    const auto weight = [](const Testimony& t, const Suspect& of) {
      const PairResult& own = of.link->link.result;
      return std::tuple(t.num_forbidden, contradicting_share(own), -own.probability);
    };
    if (accused != nullptr && weight(said, suspect) <= weight(worst, *accused)) continue;
    accused = &suspect;
    worst = said;
  }
  if (accused == nullptr) return {};
  const Link& wrong = accused->link->link;
  const PosedPair& clearest = pairs[worst.clearest];
  std::vector<RefutedLink> refuted{
      {wrong.source, wrong.target,
       fmt::format(
           "with it {} of {} pairs across it would stand where the other saw through, {} and {} with {:.0f} % of "
           "their points",
           worst.num_forbidden, worst.num_telling, name_of(scans, clearest.source), name_of(scans, clearest.target),
           100 * checks[worst.clearest]->contradiction)}};
  for (const SolvedLink& l : solution.links) {
    if (!believed(l) || !l.link.guided || &l == accused->link) continue;
    if (!accused->sides.separate(l.link.source, l.link.target)) continue;
    refuted.push_back({l.link.source, l.link.target,
                       fmt::format("found where {} - {} pointed, and {}", name_of(scans, wrong.source),
                                   name_of(scans, wrong.target), refuted.front().reason)});
  }
  return refuted;
}

}  // namespace isthmus::pipelines
