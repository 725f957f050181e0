// Links that no loop confirms, called to account: when such a link is wrong, whole parts stand where they cannot, and
// pairs of their scans that were never linked show it. A room that equals its neighbour fits; the floor around it does
// not.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pipelines/guided_pairs.h"
#include "pipelines/part_joins.h"
#include "pipelines/testimony.h"

namespace isthmus::pipelines {

/// A link that the scans on its two sides forbid.
struct RefutedLink {
  int source = 0;
  int target = 0;
  std::string reason;
};

/// For every believed link that no other link spans which is believed on its own word, the pairs of scans near it and
/// across it that would overlap most: where too many of them stand in each other's seen-through space, one link is
/// refuted: the one that most of the forbidden pairs cross, of equals the one with most free space against itself; and
/// with it the links that were believed where it pointed. Solve again without them and ask again. `scans` ascending by
/// id.
std::vector<RefutedLink> refuted_bridge(const Solution& solution, std::span<const OutlinedScan> scans,
                                        const PoseChecker& check);

/// The same for ambiguous links between two parts, each for itself: laid onto each other as the link says, may the
/// scans around its ends stand there? What they refute neither joins the parts nor argues against another link that
/// does.
std::vector<RefutedLink> refuted_joins(std::span<const PartJoin> joins, std::span<const OutlinedScan> scans,
                                       const PoseChecker& check);

}  // namespace isthmus::pipelines
