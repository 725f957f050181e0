#include "pipelines/testimony.h"

#include <algorithm>

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kWitnesses = 12;    // pairs across a link
constexpr double kTellingSupport = 0.05;  // what neither meets nor contradicts says nothing
constexpr double kMeetingSupport = 0.1;   // floors and corners meet by chance: 0.05 to 0.08 in wrong places

}  // namespace

bool Testimony::refutes() const {
  constexpr double kShareOfSeveral = 0.2, kShareOfOne = 0.5;
  const double share = num_telling > 0 ? static_cast<double>(num_forbidden) / static_cast<double>(num_telling) : 0.0;
  return share >= (num_forbidden > 1 ? kShareOfSeveral : kShareOfOne);
}

Testimony testimony_of(std::span<const PosedPair> pairs, std::span<const std::optional<PoseCheck>> checks,
                       const std::function<bool(const PosedPair&)>& about) {
  Testimony said;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!checks[k] || !about(pairs[k])) continue;
    const bool forbidden = checks[k]->forbidden();
    if (!forbidden && checks[k]->support < kTellingSupport) continue;
    ++said.num_telling;
    said.num_meeting += !forbidden && checks[k]->support >= kMeetingSupport;
    if (!forbidden) continue;
    if (said.num_forbidden++ == 0 || checks[k]->contradiction > said.clearest_contradiction)
      said.clearest = pairs[k], said.clearest_contradiction = checks[k]->contradiction;
  }
  return said;
}

std::vector<Testimony> testimonies_of(std::span<const PartJoin> joins, const PoseChecker& check) {
  std::vector<Testimony> said(joins.size());
  std::vector<PosedPair> pairs;
  std::vector<std::size_t> begin;  // of each join's pairs
  for (const PartJoin& join : joins) {
    begin.push_back(pairs.size());
    for (const GuidedPair& pair : first_witnesses(join.across)) pairs.push_back(posed(pair));
  }
  begin.push_back(pairs.size());
  if (pairs.empty()) return said;
  const std::vector<std::optional<PoseCheck>> checks = check(pairs);
  for (std::size_t k = 0; k < joins.size(); ++k) {
    const std::size_t count = begin[k + 1] - begin[k];
    said[k] = testimony_of(std::span(pairs).subspan(begin[k], count), std::span(checks).subspan(begin[k], count),
                           [](const PosedPair&) { return true; });
  }
  return said;
}

PosedPair posed(const GuidedPair& pair) { return {pair.source, pair.target, pair.target_from_source}; }

std::span<const GuidedPair> first_witnesses(const std::vector<GuidedPair>& across) {
  return std::span(across).first(std::min(across.size(), kWitnesses));
}

}  // namespace isthmus::pipelines
