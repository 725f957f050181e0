// The table of hypothesis generators: each turns two scans into seeds.
#pragma once

#include <span>
#include <string_view>
#include <utility>
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
  /// Of a ranking one: whether these seeds may settle the pair before the generators that follow are asked.
  bool (*settles)(const std::vector<Seed>& seeds) = nullptr;
};

/// Pairs of directions (from, to) that may be the same direction of the scene, the most likely first. Where both scans
/// know their vertical it is the only one: what the verticals do not explain is left to generators without an axis.
/// Else the strongest axis of one scan may be any of the other's. A sign that the normals leave open is tried both
/// ways.
std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> common_axes(std::span<const DominantAxis> from,
                                                                     std::span<const DominantAxis> to);

/// All generators, in the order they run.
std::span<const Generator> generators();

}  // namespace isthmus
