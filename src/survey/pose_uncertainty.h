// Marginal uncertainty of solved poses relative to the anchor of their component.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "survey/link_model.h"

namespace isthmus::survey {

/// Largest standard deviations over all directions.
struct PoseSigma {
  double translation_m = 0;
  double rotation_rad = 0;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the right perturbation (translation, rotation vector), node's frame
};

/// Inverts the normal matrix of the measurements at the solution (dense: meant for some hundred nodes). Absent for
/// fixed nodes and for nodes that no measurement ties to one. `fixed` holds one node per part.
std::vector<std::optional<PoseSigma>> pose_sigmas(const std::vector<Transform>& root_from_node,
                                                  std::span<const Measurement> measurements,
                                                  const std::vector<int>& fixed);

}  // namespace isthmus::survey
