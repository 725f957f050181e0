// Links that no loop confirms, called to account: when such a link is wrong, whole parts stand where they cannot, and
// pairs of their scans that were never linked show it. A room that equals its neighbour fits; the floor around it does
// not.
#pragma once

#include <span>
#include <string>
#include <utility>
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

/// For every scan and every branch that its part falls into without it, the pairs of scans near the links between them
/// and across them that would overlap most; likewise for every believed link that no link spans which is believed on
/// its own word. Where too many of these pairs stand in each other's seen-through space, the links of one branch are
/// refuted: those that are likeliest to be wrong by the pairs that they lay on each other and by their own word; where
/// another branch is nearly as likely, those of both; and with them the links that were believed where they pointed.
/// Solve again without them and ask again. `scans` ascending by id; the answer ascending by (source, target).
std::vector<RefutedLink> refuted_bridge(const Solution& solution, std::span<const OutlinedScan> scans,
                                        const PoseChecker& check);

/// Of refuted links between two parts (part_joins.h) those that the parts as they stand now speak for: some of the
/// pairs across meet and none is forbidden. What accused them may have been another wrong link, which is gone.
std::vector<std::pair<int, int>> acquitted_links(std::span<const PartJoin> joins, const PoseChecker& check);

/// The same for ambiguous links between two parts, each for itself: laid onto each other as the link says, may the
/// scans around its ends stand there? What they refute neither joins the parts nor argues against another link that
/// does.
std::vector<RefutedLink> refuted_joins(std::span<const PartJoin> joins, std::span<const OutlinedScan> scans,
                                       const PoseChecker& check);

}  // namespace isthmus::pipelines
