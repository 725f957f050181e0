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

/// Adds the source points `sample` against the target's surface. gate_m: largest distance along the normal that counts;
/// residuals are weighted by (1 - (r / gate)^2)^2 (Tukey).
void add_point_to_plane(const ScanModel& source, const ScanModel& target, const Transform& target_from_source,
                        std::span<const std::uint32_t> sample, bool coarse, float gate_m, const Eigen::Vector3d& centre,
                        NormalEquations& equations);

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
