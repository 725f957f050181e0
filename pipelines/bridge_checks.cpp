#include "pipelines/bridge_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "pairwise/judge.h"
#include "pipelines/testimony.h"

namespace isthmus::pipelines {
namespace {

/// Believed on its own word: neither told where to look nor ambiguous until others agreed. Where rooms repeat,
/// ambiguous links agree with the wrong one.
bool strong(const SolvedLink& l) { return believed(l) && !l.link.guided && l.measured == Verdict::accepted; }

/// What lies on either side of a link that nothing else spans; absent for a link on a loop.
struct Sides {
  std::map<int, int> of_source, of_target;
  [[nodiscard]] bool separate(int a, int b) const {
    return (of_source.contains(a) && of_target.contains(b)) || (of_source.contains(b) && of_target.contains(a));
  }
};
std::optional<Sides> sides_of(const Solution& solution, const SolvedLink& link) {
  const auto others = [&](const SolvedLink& l) { return strong(l) && &l != &link; };
  Sides sides{link_distances(solution, link.link.source, others), {}};
  if (sides.of_source.contains(link.link.target)) return std::nullopt;
  sides.of_target = link_distances(solution, link.link.target, others);
  return sides;
}

struct Suspect {
  const SolvedLink* link = nullptr;
  Sides sides;
};

std::string name_of(std::span<const OutlinedScan> scans, int id) {
  const auto at = std::ranges::lower_bound(scans, id, {}, &OutlinedScan::id);
  return at != scans.end() && at->id == id && !at->name.empty() ? at->name : std::to_string(id);
}

std::string text_of(const Testimony& said, std::span<const OutlinedScan> scans) {
  return fmt::format(
      "with it {} of {} pairs across it would stand where the other saw through, {} and {} with {:.0f} % of their "
      "points",
      said.num_forbidden, said.num_telling, name_of(scans, said.clearest.source), name_of(scans, said.clearest.target),
      100 * said.clearest_contradiction);
}

}  // namespace

std::vector<RefutedLink> refuted_bridge(const Solution& solution, std::span<const OutlinedScan> scans,
                                        const PoseChecker& check) {
  const Summaries summaries = summaries_of(scans);
  std::vector<PosedPair> pairs;
  std::set<std::pair<int, int>> known;
  std::vector<Suspect> suspects;
  for (const SolvedLink& solved : solution.links) {
    if (!believed(solved) || solved.link.guided) continue;
    auto sides = sides_of(solution, solved);
    if (!sides) continue;
    const std::vector<GuidedPair> across =
        pairs_across(sides->of_source, sides->of_target, summaries,
                     [&](int source, int target) { return predicted_target_from_source(solution, source, target); });
    for (const GuidedPair& pair : first_witnesses(across))
      if (known.emplace(pair.source, pair.target).second) pairs.push_back(posed(pair));
    suspects.push_back({&solved, std::move(*sides)});
  }
  if (pairs.empty()) return {};
  const std::vector<std::optional<PoseCheck>> checks = check(pairs);
  const Suspect* accused = nullptr;
  Testimony worst;
  for (const Suspect& suspect : suspects) {
    const Link& accused_link = suspect.link->link;
    const Testimony said = testimony_of(pairs, checks, [&](const PosedPair& pair) {
      return std::minmax(pair.source, pair.target) != std::minmax(accused_link.source, accused_link.target) &&
             suspect.sides.separate(pair.source, pair.target);
    });
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
  std::vector<RefutedLink> refuted{{wrong.source, wrong.target, text_of(worst, scans)}};
  for (const SolvedLink& l : solution.links) {
    if (!believed(l) || &l == accused->link) continue;
    if (!accused->sides.separate(l.link.source, l.link.target)) continue;
    refuted.push_back({l.link.source, l.link.target,
                       fmt::format("believed where {} - {} pointed, and {}", name_of(scans, wrong.source),
                                   name_of(scans, wrong.target), refuted.front().reason)});
  }
  return refuted;
}

std::vector<RefutedLink> refuted_joins(std::span<const PartJoin> joins, std::span<const OutlinedScan> scans,
                                       const PoseChecker& check) {
  std::vector<PartJoin> asked;  // one that free space forbids has no vote: nothing is lost by it
  std::ranges::copy_if(joins, std::back_inserter(asked),
                       [](const PartJoin& join) { return !forbidden_by_free_space(join.link->link.result); });
  const std::vector<Testimony> said = testimonies_of(asked, check);
  std::vector<RefutedLink> refuted;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const Link& link = asked[k].link->link;
    if (said[k].refutes()) refuted.push_back({link.source, link.target, text_of(said[k], scans)});
  }
  return refuted;
}

}  // namespace isthmus::pipelines
