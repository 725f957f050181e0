// Point-to-plane alignment over surface lookups: the small step inside growth and refinement.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "geometry/transform.h"
#include "regions/scan_model.h"

namespace isthmus {

/// Normal equations of one linearised point-to-plane step (Chen, Medioni 1992; Low 2004), left perturbation of
/// target_from_source about `centre` (target frame): p -> p + w x (p - centre) + v, unknowns (v, w).
struct NormalEquations {
  Matrix6d a = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double weight = 0;
  double sq_residual_sum = 0;  ///< weighted, m2
  std::size_t matches = 0;
};

enum class MatchWeights {
  alike,         ///< but for the residual: what is rough tells as well where a scan lies
  by_roughness,  ///< by the inverse variance that the roughness of both surfaces gives a residual
};

/// Adds the source points `sample` against the target's surface. gate_m: largest distance along the normal that counts;
/// residuals are weighted by (1 - (r / gate)^2)^2 (Tukey), and as `weights` says.
void add_point_to_plane(const ScanModel& source, const ScanModel& target, const Transform& target_from_source,
                        std::span<const std::uint32_t> sample, bool coarse, float gate_m, const Eigen::Vector3d& centre,
                        NormalEquations& equations, MatchWeights weights = MatchWeights::alike);

/// How well the worst direction of the place is held, as a share of the best: the ratio of the stiffness's eigenvalues;
/// 0 where nothing holds it.
double observability(const NormalEquations& equations);

/// Whether there is enough that is flat: its weight is a share of what all matches weigh alike (in woods 0.04 to 0.11,
/// elsewhere 0.18 to 0.67), and it fixes the place in all directions about as well, against the best one. Where stems
/// and shrubs hold the scan, roughness is no reason to doubt them.
bool flat_surfaces_hold(const NormalEquations& by_roughness, const NormalEquations& alike);

/// Distances along the target's normals, absolute, of the source points that such a step would use; metres.
std::vector<float> distances_to_planes(const ScanModel& source, const ScanModel& target,
                                       const Transform& target_from_source, std::span<const std::uint32_t> sample,
                                       float gate_m);

/// How far one step may go; a longer one is shortened as a whole.
struct StepLimit {
  double translation_m = std::numeric_limits<double>::infinity();
  double rotation_rad = std::numeric_limits<double>::infinity();
};

/// The step's solution, damped so that directions nobody observes stay where they are.
Transform solved_step(const NormalEquations& equations, const Eigen::Vector3d& centre, double voxel_m,
                      const StepLimit& limit = {});

}  // namespace isthmus
