// From evidence to a probability and a verdict.
#pragma once

#include "pairwise/hypothesis.h"
#include "pairwise/pair_result.h"
#include "pairwise/register_pair.h"

namespace isthmus {

/// The terms the verdict is made of, in a fixed order.
struct PairEvidence {
  double score = 0;          ///< of the best hypothesis, see weigh()
  double near_score = 0;     ///< of the next best pose in the same basin: how well the place is fixed
  double rival_score = 0;    ///< of the best pose elsewhere, at least 0
  double rival_voxels = 0;   ///< how far apart the two put the source's middle; 0 without a rival
  double rival_deg = 0;      ///< and how differently they turn it
  double support = 0;        ///< the smaller direction
  double rare_support = 0;   ///< the smaller direction
  double contradiction = 0;  ///< the larger direction
  double against = 0;        ///< the larger direction
  double rms_voxels = 0;
  double observability = 0;  ///< smallest over largest stiffness against translation, 0 = slides freely
  double num_supported = 0;  ///< voxel points on the other scan's surface, the smaller direction
  bool free_space = false;   ///< at least one scan has a known station
  double passed_over = 0;    ///< score of a pose that explains more and that free space forbids; 0 without one
  /// Of the source points that face a target point near them, the shares this close to its plane; said, not weighed.
  double share_under_6mm = 0, share_under_20mm = 0;
};

/// Probability that the best hypothesis is right: logistic regression over the evidence, see docs/stages/verdict.md for
/// the sets it was fitted on and the sets it was checked on.
double probability_of(const PairEvidence& evidence);

/// The same for a result, as if the best pose elsewhere had this score: where others rule out what stood against it.
double probability_against(const PairResult& result, double rival_score);

/// Share of what lies in sight of the other station that contradicts the pose; 0 where nothing was measured.
double contradicting_share(const PairResult& result);

/// Whether free space forbids the pose: too much of a scan stands where the other station saw through. No support, and
/// no other link that agrees, outweighs it: rooms that repeat agree with each other. Of a pair that is not sure by
/// itself, or whose support other hypotheses share, less is too much, the less the more the scans overlap. True as well
/// of a pose that only took the place of a forbidden one: in an office of 160 such poses agreed with each other on the
/// wrong lobby. False where nothing was measured.
bool forbidden_by_free_space(const PairResult& result);

/// By how much free space discounts the score of a pose against others of its pair: `overlap` of the smaller direction,
/// `contradiction` of the larger one; 1 = not at all.
double free_space_discount(double overlap, double contradiction);
inline constexpr double kMostDiscount = 5;

/// Verdict, probability and reason of `result`, from its evidence.
void judge(const PairEvidence& evidence, const PairOptions& options, PairResult& result);

}  // namespace isthmus
