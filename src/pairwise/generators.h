// The table of hypothesis generators: each turns two scans into seeds.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "pairwise/register_pair.h"
#include "regions/seeds.h"

namespace isthmus {

struct GeneratorContext {
  const ScanModel& source;
  const ScanModel& target;
  const MatchTable& matches;
  const PairOptions& options;
};

struct Generator {
  std::string_view name;
  std::vector<Seed> (*propose)(const GeneratorContext& context);
  bool ranks;  ///< its seeds come with a score over whole scans; the others are scored around their regions
};

/// All generators, in the order they run.
std::span<const Generator> generators();

}  // namespace isthmus
