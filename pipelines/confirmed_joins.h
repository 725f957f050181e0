// Parts laid onto each other as wholes. A single pair at little overlap may not tell a room from the next one; the
// parts that it would join are made of many scans, and where several of them meet under its pose, none stands in
// another's seen-through space, and its rivals would put them where they cannot stand, the parts say what the pair
// could not.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pipelines/part_joins.h"
#include "pipelines/testimony.h"

namespace isthmus::pipelines {

/// An ambiguous link between two components that the scans around its ends confirm.
struct ConfirmedLink {
  int source = 0;
  int target = 0;
  double probability = 0;
  std::string reason;
};

/// Of joins that are not refuted those whose probability reaches `accept_probability`, given what the pairs across them
/// say: a rival that its own pairs across refute no longer stands against the link, and pairs that meet and contradict
/// nothing raise its odds, as far as they are more than those of a rival that may stand. At most one for each two
/// components, the most probable, and none where two probable links between them disagree.
std::vector<ConfirmedLink> confirmed_joins(std::span<const PartJoin> joins, const Solution& solution,
                                           std::span<const OutlinedScan> scans, const PoseChecker& check,
                                           double accept_probability);

}  // namespace isthmus::pipelines
