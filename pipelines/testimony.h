// What pairs of scans that were never linked say about a link that would lay them on each other.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pairwise/check_pose.h"
#include "pipelines/guided_pairs.h"
#include "pipelines/model_pairs.h"
#include "pipelines/part_joins.h"

namespace isthmus::pipelines {

using PoseChecker = std::function<std::vector<std::optional<PoseCheck>>(std::span<const PosedPair>)>;

/// What the checked pairs across a suspect say, whoever called them.
struct Testimony {
  std::size_t num_telling = 0, num_forbidden = 0;
  std::size_t num_meeting = 0;        ///< not forbidden, and so well on each other's surfaces that chance is no reason
  PosedPair clearest;                 ///< of the forbidden ones, the pair with the most contradiction
  double clearest_contradiction = 0;  ///< its share
  /// Of 167 true pairs none was forbidden; of a floor one room off 37 of the 48 that meet, fewer where the rooms were
  /// chosen to fit. One forbidden pair alone may be a door or a van.
  [[nodiscard]] bool refutes() const;
};

/// `about` says whether a pair has a say. A pair that neither meets nor contradicts says nothing.
Testimony testimony_of(std::span<const PosedPair> pairs, std::span<const std::optional<PoseCheck>> checks,
                       const std::function<bool(const PosedPair&)>& about);

/// For each join what the first few pairs across it say; all are checked at once, and nothing is if there are none.
std::vector<Testimony> testimonies_of(std::span<const PartJoin> joins, const PoseChecker& check);

PosedPair posed(const GuidedPair& pair);

/// The first few of pairs that are sorted by predicted overlap.
std::span<const GuidedPair> first_witnesses(const std::vector<GuidedPair>& across);

}  // namespace isthmus::pipelines
