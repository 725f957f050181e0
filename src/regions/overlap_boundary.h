// The boundary of an overlap: where one scan goes on and the other does not.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace isthmus {

/// For each point of `sample` (indices into `points`) 1 if it is at the boundary of the overlap: a quarter or more of
/// the points within `reach_m` of it are outside. One odd point without a partner makes no boundary. `inside` has one
/// mark per point, 1 = in the overlap.
std::vector<std::uint8_t> at_overlap_boundary(std::span<const Eigen::Vector3f> points,
                                              std::span<const std::uint8_t> inside,
                                              std::span<const std::uint32_t> sample, float reach_m);

}  // namespace isthmus
