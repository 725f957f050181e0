#include "pairwise/screen_pair.h"

#include <algorithm>

#include "pairwise/generators.h"
#include "regions/column_votes.h"
#include "regions/grow.h"
#include "regions/stem_votes.h"

namespace isthmus {

std::optional<double> screen_pair(const ScanModel& source, const ScanModel& target) {
  constexpr std::size_t kMaxAxisPairs = 2;
  ColumnVoteOptions votes;  // as few as still find two thirds of the right poses above 10 % overlap
  votes.plan.max_columns = 250;
  votes.max_checked = 150;
  votes.max_seeds = 8;
  StemVoteOptions stems;
  stems.max_stems = 120;
  stems.max_settled = 300;
  stems.max_seeds = 2;
  auto axes = common_axes(source.features.axes, target.features.axes);
  if (axes.size() > kMaxAxisPairs) axes.resize(kMaxAxisPairs);
  std::optional<double> best;
  const auto look_at = [&](const std::vector<Seed>& seeds) {
    for (const GrownOverlap& grown : grow_all(source, target, seeds, {}))
      best = std::max(best.value_or(static_cast<double>(grown.score)), static_cast<double>(grown.score));
  };
  for (const auto& [from, to] : axes) {
    const std::vector<Seed> by_stems = vote_seeds_by_stems(source, target, from, to, stems);
    look_at(by_stems);
    if (stems_settle(by_stems)) return best;
  }
  for (const auto& [from, to] : axes) look_at(vote_seeds_by_columns(source, target, from, to, votes));
  return best;
}

}  // namespace isthmus
