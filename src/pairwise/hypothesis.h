// Hypotheses of one pair: polished, weighed against each other, ranked.
#pragma once

#include <vector>

#include "geometry/transform.h"
#include "regions/overlap_score.h"
#include "regions/scan_model.h"

namespace isthmus {

/// What one scan says about a pose: shares of its sampled points.
struct DirectedEvidence {
  double support = 0;        ///< on the other scan's surface within a tight tolerance, facing the same way
  double rare_support = 0;   ///< the same, each point weighing by how few of the pair's hypotheses support it
  double contradiction = 0;  ///< where the other station saw through
  double against = 0;        ///< close to a surface that faces the opposite way
};

struct Hypothesis {
  Transform target_from_source = Transform::Identity();
  const char* generator = "";
  DirectedEvidence source, target;
  double rms_m = 0;    ///< of the polish, point-to-plane
  double score = 0;    ///< ranking: the larger the better
};

/// A few point-to-plane steps in both directions with a shrinking gate, on up to `max_points` points a direction.
void polish(const ScanModel& source, const ScanModel& target, std::size_t max_points, int steps, Hypothesis& hypothesis);

/// Of hypotheses that put the source's points within `position_m` (95 % of its extent considered) of each other, the best
/// scored stays.
void keep_distinct(const ScanModel& source, double position_m, std::vector<Hypothesis>& hypotheses);

/// Fills the evidence and score of all and sorts them best first. What every hypothesis explains (floors, long walls) weighs
/// little: a point's weight is the logarithm of the inverse share of hypotheses that support it, as in document retrieval
/// (Sparck Jones 1972), so there is no prior notion of what is common in a scene.
void weigh(const ScanModel& source, const ScanModel& target, std::size_t max_points, std::vector<Hypothesis>& hypotheses);

}  // namespace isthmus
