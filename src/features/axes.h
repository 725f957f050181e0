// Dominant axes of a scan: the vertical of a levelled scene, the directions of a building.
#pragma once

#include <span>
#include <vector>

#include "features/feature_cloud.h"

namespace isthmus {

/// Directions d with many normals along them (ground, ceilings, walls) and many across (walls, trunks), strongest
/// first, at most `max_axes`, at least 30 degrees apart. `variation` as in SampledScan: only flat surroundings count. A
/// direction must hold more than twice the share of parallel normals that even scatter would, and 4 % of all, or three
/// times the share of normals across that even scatter would (trunks over rough ground); and half of the weight of the
/// strongest. Empty if there is none.
std::vector<DominantAxis> dominant_axes(std::span<const Eigen::Vector3f> normals, std::span<const float> variation,
                                        std::size_t max_axes);

}  // namespace isthmus
