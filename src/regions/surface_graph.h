// Neighbouring sampled points of a scan: what surfaces are grown over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scan/sampled_scan.h"

namespace isthmus {

/// For each sampled point with a normal the other such points within `reach_m`, ascending.
class SurfaceGraph {
 public:
  SurfaceGraph(const SampledScan& scan, float reach_m);
  [[nodiscard]] std::span<const std::uint32_t> around(std::size_t i) const {
    return std::span(neighbours_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> neighbours_;
};

/// Voxel centroids of one surface lie this close: the diagonal of a voxel and a little more.
inline constexpr float kSurfaceReachVoxels = 1.8f;

}  // namespace isthmus
