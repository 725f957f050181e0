// Compact clusters of points.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace isthmus {

/// The cluster of each point, below `k`; some may be empty. Farthest-point seeds (Gonzalez 1985), beginning with the
/// first point, then six of Lloyd's iterations (Lloyd 1982). Ties go to the smaller index; nothing is random.
std::vector<std::uint32_t> compact_clusters(std::span<const Eigen::Vector3f> points, std::size_t k);

}  // namespace isthmus
