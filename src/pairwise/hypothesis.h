// Hypotheses of one pair: polished, weighed against each other, ranked.
#pragma once

#include <memory>
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

/// What the sampled points of one scan say about a pose, point by point.
struct Profile {
  std::vector<float> support;  ///< per sampled point, 0 to 1
  double contradiction = 0, against = 0;
  Eigen::Matrix3f stiffness = Eigen::Matrix3f::Zero();  ///< sum of support x normal normal^T, in the other scan's frame
};

/// Both directions of one pose. Hypotheses are weighed again whenever their set changes; their points say the same as
/// long as the pose stays.
struct PoseProfiles {
  Transform target_from_source = Transform::Identity();
  const ScanModel* source = nullptr;  ///< the level that was asked
  std::size_t max_points = 0;
  Profile forward, backward;
};

struct Hypothesis {
  Transform target_from_source = Transform::Identity();
  const char* generator = "";
  const void* climbed_on = nullptr;  ///< the source's model (a level) that climb() was last called with
  DirectedEvidence source, target;
  double rms_m = 0;                              ///< of the polish, point-to-plane
  double score = 0;                              ///< ranking: the larger the better
  std::shared_ptr<const PoseProfiles> profiles;  ///< of the last weighing
};

/// A few point-to-plane steps in both directions with a shrinking gate, on up to `max_points` points a direction.
void polish(const ScanModel& source, const ScanModel& target, std::size_t max_points, int steps,
            Hypothesis& hypothesis);

/// The same, and steps on whose gate is as narrow as the residuals' median allows: what corners, edges and foliage
/// leave is left out, planes decide. Either is taken back where it loses support: rough normals can lead a good pose
/// astray.
void polish_closely_unless_worse(const ScanModel& source, const ScanModel& target, std::size_t max_points, int steps,
                                 Hypothesis& hypothesis);

/// Pattern search (Hooke, Jeeves 1961) over the six degrees of freedom about the middle of the overlap, uphill in
/// support and free space themselves: where normals are rough, as in foliage, point-to-plane steps do not find the way.
/// Steps of `first_step_voxels` are halved until an eighth of a voxel, and the tolerance narrows with them. Never ends
/// below its start.
void climb(const ScanModel& source, const ScanModel& target, std::size_t max_points, double first_step_voxels,
           Hypothesis& hypothesis);

/// Of hypotheses that put the source's points within `position_m` (95 % of its extent considered) of each other, the
/// best scored stays.
void keep_distinct(const ScanModel& source, double position_m, std::vector<Hypothesis>& hypotheses);

/// Whether two poses are the same answer, found with a different error: a rival is one that is not.
bool same_basin(const ScanModel& source, const Transform& a, const Transform& b);

struct Weighing {
  std::size_t max_points = 2000;  ///< of each scan
  bool rarity = true;             ///< false: every point weighs the same
  bool free_space = true;         ///< false: contradictions do not lower the score
  bool upright = true;            ///< false: verticals that are turned apart do not either
  bool observed = true;           ///< false: nor do directions that nothing fixes
};

/// Fills the evidence and score of all and sorts them best first. What every hypothesis explains (floors, long walls)
/// weighs little: a point's weight is the logarithm of the inverse share of hypotheses that support it, as in document
/// retrieval (Sparck Jones 1972), so there is no prior notion of what is common in a scene. Poses of one basin count as
/// one hypothesis: many errors of the truth do not make it common.
void weigh(const ScanModel& source, const ScanModel& target, const Weighing& weighing,
           std::vector<Hypothesis>& hypotheses);

}  // namespace isthmus
