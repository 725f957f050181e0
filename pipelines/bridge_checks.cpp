#include "pipelines/bridge_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "base/parallel.h"
#include "pairwise/judge.h"
#include "pipelines/testimony.h"

namespace isthmus::pipelines {
namespace {

/// Believed on its own word: neither told where to look nor ambiguous until others agreed. Where rooms repeat,
/// ambiguous links agree with the wrong one.
bool strong(const SolvedLink& l) { return believed(l) && !l.link.guided && l.measured == Verdict::accepted; }

/// Links of one scan that alone hold a branch of its part to it; on either side the scans and over how many links they
/// hang on one of these links' ends.
struct Suspect {
  int scan = 0;
  std::vector<const SolvedLink*> links;
  std::map<int, int> on_its_side, in_branch;
  [[nodiscard]] bool separates(int a, int b) const {
    return (on_its_side.contains(a) && in_branch.contains(b)) || (on_its_side.contains(b) && in_branch.contains(a));
  }
  [[nodiscard]] bool holds(int a, int b) const {
    return std::ranges::any_of(
        links, [&](const SolvedLink* l) { return std::minmax(l->link.source, l->link.target) == std::minmax(a, b); });
  }
  /// Whether a pair across tells about these links: not one that they hold, which has had its say.
  [[nodiscard]] bool hears(const PosedPair& pair) const {
    return separates(pair.source, pair.target) && !holds(pair.source, pair.target);
  }
  /// The link that says most for it. They speak for the same place: where it is a room that equals the right one, all
  /// are wrong for one reason.
  [[nodiscard]] const PairResult& spokesman() const {
    return (*std::ranges::max_element(links, {}, [](const SolvedLink* l) { return l->link.result.probability; }))
        ->link.result;
  }
};

/// Every believed link that is not strong and that strong ones do not span.
void add_weak_links(std::vector<Suspect>& suspects, const Solution& solution, const LinksOf& links_of) {
  for (const SolvedLink& l : solution.links) {
    if (!believed(l) || l.link.guided || strong(l)) continue;
    Suspect suspect{l.link.target, {&l}, link_distances(links_of, {l.link.target}), {}};
    if (suspect.on_its_side.contains(l.link.source)) continue;
    suspect.in_branch = link_distances(links_of, {l.link.source});
    suspects.push_back(std::move(suspect));
  }
}

/// For every scan the branches that its part falls into without it. A link that nothing spans comes once, by the
/// smaller of its ends.
std::vector<Suspect> suspects_of(const Solution& solution) {
  const LinksOf links_of = links_of_scans(solution, strong);
  std::vector<Suspect> suspects;
  add_weak_links(suspects, solution, links_of);
  for (const auto& [scan, links] : links_of) {
    std::set<int> seen;
    for (const SolvedLink* first : links) {
      if (seen.contains(other_end(*first, scan))) continue;
      Suspect suspect{scan, {}, {}, {}};
      const auto is_scan = [scan = scan](int id) { return id == scan; };
      const auto branch = link_distances(links_of, {other_end(*first, scan)}, is_scan);
      std::vector<int> ends;
      for (const SolvedLink* l : links) {
        if (!branch.contains(other_end(*l, scan))) continue;
        suspect.links.push_back(l);
        ends.push_back(other_end(*l, scan));
      }
      for (const auto& [id, distance] : branch) seen.insert(id);
      if (suspect.links.size() == 1 && ends.front() < scan) continue;
      suspect.in_branch = link_distances(links_of, std::move(ends), is_scan);
      suspect.on_its_side = link_distances(links_of, {scan}, [&](int id) { return branch.contains(id); });
      suspects.push_back(std::move(suspect));
    }
  }
  return suspects;
}

/// That a group of links is wrong, by what the pairs across say and by its own word. Pairs that a right link lays on
/// each other are forbidden once in a hundred at most (of 167 none), of those across wrong links of an office of 160
/// every second (30 of 56).
double log_odds_wrong(const Testimony& said, const PairResult& own) {
  constexpr double kForbiddenIfRight = 0.01, kForbiddenIfWrong = 0.5;
  const double of_forbidden = std::log(kForbiddenIfWrong / kForbiddenIfRight);
  const double of_fine = std::log((1 - kForbiddenIfWrong) / (1 - kForbiddenIfRight));
  constexpr double kSurest = 1e-6;
  const double right = std::clamp(own.probability, kSurest, 1 - kSurest);
  const auto num_forbidden = static_cast<double>(said.num_forbidden);
  return num_forbidden * of_forbidden + (static_cast<double>(said.num_telling) - num_forbidden) * of_fine -
         std::log(right / (1 - right));
}

/// Who is asked: the scans near the links, and by itself the scan that they hold.
std::vector<GuidedPair> witnesses_of(const Suspect& suspect, const Summaries& summaries, const Posing& posing) {
  const std::vector<GuidedPair> across = pairs_across(suspect.on_its_side, suspect.in_branch, summaries, posing);
  std::vector<GuidedPair> of_scan;
  std::ranges::copy_if(across, std::back_inserter(of_scan), [&](const GuidedPair& pair) {
    return pair.source == suspect.scan || pair.target == suspect.scan;
  });
  const auto all = first_witnesses(across), own = first_witnesses(of_scan);
  std::vector<GuidedPair> witnesses(all.begin(), all.end());
  witnesses.insert(witnesses.end(), own.begin(), own.end());
  return witnesses;
}

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

struct Accusation {
  const Suspect* suspect = nullptr;
  Testimony said;
  double log_odds = 0;  ///< that it is wrong
};

std::string name_of(const SolvedLink& l, std::span<const OutlinedScan> scans) {
  return fmt::format("{} - {}", name_of(scans, l.link.source), name_of(scans, l.link.target));
}

/// The links of the likeliest, and of all that are nearly as likely and that a same forbidden pair accuses; with them
/// what was believed where they pointed.
std::vector<RefutedLink> sentenced(std::vector<Accusation> accusations, std::span<const PosedPair> pairs,
                                   std::span<const std::optional<PoseCheck>> checks, const Solution& solution,
                                   std::span<const OutlinedScan> scans) {
  constexpr double kSureOfOne = 3;  // 0.95 against the next
  if (accusations.empty()) return {};
  std::ranges::stable_sort(accusations, std::ranges::greater(), &Accusation::log_odds);
  const Accusation first = accusations.front();
  const auto shares_a_witness = [&](const Accusation& other) {
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (checks[k] && checks[k]->forbidden() && first.suspect->hears(pairs[k]) && other.suspect->hears(pairs[k]))
        return true;
    return false;
  };
  std::erase_if(accusations, [&](const Accusation& other) {
    return other.suspect != first.suspect &&
           (other.log_odds <= first.log_odds - kSureOfOne || !shares_a_witness(other));
  });
  std::map<std::pair<int, int>, RefutedLink> refuted;  // each link once, by the likeliest that takes it
  const auto refute = [&](const Link& link, const std::string& reason) {
    refuted.try_emplace({link.source, link.target}, RefutedLink{link.source, link.target, reason});
  };
  for (const Accusation& accusation : accusations) {
    std::string reason = text_of(accusation.said, scans);
    for (const Accusation& other : accusations)
      if (other.suspect != accusation.suspect)
        reason += fmt::format(", or with {}", name_of(*other.suspect->links.front(), scans));
    for (const SolvedLink* l : accusation.suspect->links) refute(l->link, reason);
  }
  for (const Accusation& accusation : accusations)
    for (const SolvedLink& l : solution.links) {
      if (!believed(l) || !accusation.suspect->separates(l.link.source, l.link.target)) continue;
      refute(l.link, fmt::format("believed where {} pointed, and {}",
                                 name_of(*accusation.suspect->links.front(), scans), text_of(accusation.said, scans)));
    }
  std::vector<RefutedLink> out;
  for (auto& [ids, link] : refuted) out.push_back(std::move(link));
  return out;
}

}  // namespace

std::vector<RefutedLink> refuted_bridge(const Solution& solution, std::span<const OutlinedScan> scans,
                                        const PoseChecker& check) {
  const Summaries summaries = summaries_of(scans);
  const std::vector<Suspect> suspects = suspects_of(solution);
  const auto posing = [&](int source, int target) { return predicted_target_from_source(solution, source, target); };
  std::vector<std::vector<GuidedPair>> witnesses(suspects.size());
  parallel_for_index(suspects.size(), 1,
                     [&](std::size_t k) { witnesses[k] = witnesses_of(suspects[k], summaries, posing); });
  std::vector<PosedPair> pairs;
  std::set<std::pair<int, int>> known;
  for (const auto& of_suspect : witnesses)
    for (const GuidedPair& pair : of_suspect)
      if (known.emplace(pair.source, pair.target).second) pairs.push_back(posed(pair));
  if (pairs.empty()) return {};
  const std::vector<std::optional<PoseCheck>> checks = check(pairs);
  std::vector<Accusation> accusations;
  for (const Suspect& suspect : suspects) {
    const Testimony said = testimony_of(pairs, checks, [&](const PosedPair& pair) { return suspect.hears(pair); });
    Testimony with_links = said;  // that several agree tells as well, for whether there is a case at all
    if (suspect.links.size() > 1) with_links.num_telling += suspect.links.size();
    if (with_links.refutes()) accusations.push_back({&suspect, said, log_odds_wrong(said, suspect.spokesman())});
  }
  return sentenced(std::move(accusations), pairs, checks, solution, scans);
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

std::vector<std::pair<int, int>> acquitted_links(std::span<const PartJoin> joins, const PoseChecker& check) {
  const std::vector<Testimony> said = testimonies_of(joins, check);
  std::vector<std::pair<int, int>> acquitted;
  for (std::size_t k = 0; k < joins.size(); ++k)
    if (said[k].num_forbidden == 0 && said[k].num_meeting > 0)
      acquitted.emplace_back(joins[k].link->link.source, joins[k].link->link.target);
  return acquitted;
}

}  // namespace isthmus::pipelines
