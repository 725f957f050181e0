// One trial: a base of the source, its congruent sets in the target, the best transforms they give.
#pragma once

#include "base/rng.h"
#include "congruent/bases.h"
#include "congruent/best_transforms.h"
#include "congruent/pairs.h"
#include "congruent/register.h"
#include "congruent/score.h"

namespace isthmus::congruent {

/// What all trials share; everything in the recentred frames of the working copies.
struct TrialSetting {
  const LocalCloud& source;
  const LocalCloud& target;                    ///< the points that pairs are drawn from
  const PairIndex& pairs;                      ///< of `target`
  const FacingGrid& grid;                      ///< of the whole target
  const ScoreSample& sample;                   ///< of `source`
  const std::vector<PointPair>& source_pairs;  ///< of `source`, drawn by lot: they tell how common a diagonal is
  const CongruentSearch& search;               ///< prior and verticals, in the recentred frames
  const CongruentOptions& options;
  double tolerance_m = 0;
  BaseWish wish;
  double distinct_m = 0;     ///< transforms nearer than this are the same
  std::size_t num_kept = 1;  ///< transforms that a trial may hand on
};

struct TrialOutcome {
  BestTransforms best;
  CongruentCounts counts;
};

/// A pure function of its arguments: trials may run in any order and at once. Transforms with no more than `to_beat`
/// common points are left out.
TrialOutcome run_trial(const TrialSetting& setting, int trial, Rng rng, std::int64_t to_beat);

/// True if the transform lies within the prior's bounds, each widened by the slack given.
bool within(const CongruentPrior& prior, const Transform& target_from_source, double slack_rad, double slack_m);

}  // namespace isthmus::congruent
