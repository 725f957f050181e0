// A few steps that pull a transform onto the target's surface.
#pragma once

#include "congruent/score.h"

namespace isthmus::congruent {

/// Gauss-Newton steps, point-to-plane where the target has normals (Chen and Medioni 1992) and point-to-point where
/// not, over sample points with a facing target point within the grid's tolerance. Directions that the surface leaves
/// open (sliding along a wall) are held. Returns the input when fewer than six points correspond.
Transform refined(const FacingGrid& grid, const LocalCloud& target, const ScoreSample& sample,
                  const Transform& target_from_source, int steps);

}  // namespace isthmus::congruent
