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
    if (said.num_forbidden++ == 0 || checks[k]->contradiction > checks[said.clearest]->contradiction) said.clearest = k;
  }
  return said;
}

PosedPair posed(const GuidedPair& pair) { return {pair.source, pair.target, pair.target_from_source}; }

std::span<const GuidedPair> first_witnesses(const std::vector<GuidedPair>& across) {
  return std::span(across).first(std::min(across.size(), kWitnesses));
}

}  // namespace isthmus::pipelines
