#include "pairwise/screen_pair.h"

#include <algorithm>

#include "pairwise/generators.h"
#include "regions/column_votes.h"
#include "regions/grow.h"

namespace isthmus {

std::optional<double> screen_pair(const ScanModel& source, const ScanModel& target) {
  constexpr std::size_t kMaxAxisPairs = 2;
  ColumnVoteOptions votes;  // as few as still find two thirds of the right poses above 10 % overlap
  votes.max_columns = 250;
  votes.max_checked = 150;
  votes.max_seeds = 8;
  auto axes = common_axes(source.features.axes, target.features.axes);
  if (axes.size() > kMaxAxisPairs) axes.resize(kMaxAxisPairs);
  std::optional<double> best;
  for (const auto& [from, to] : axes)
    for (const Seed& seed : vote_seeds_by_columns(source, target, from, to, votes)) {
      const auto score = static_cast<double>(grow(source, target, seed, {}).score);
      best = std::max(best.value_or(score), score);
    }
  return best;
}

}  // namespace isthmus
