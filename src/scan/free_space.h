// Cube map directions and the free-space image of a station.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "scan/sampled_scan.h"

namespace isthmus {

/// Cell of the direction `d` (any length, not zero) on a cube map of `size` cells a side: face * size^2 + row * size +
/// column.
inline std::uint32_t cube_cell(const Eigen::Vector3f& d, std::uint32_t size) {
  const float ax = std::abs(d.x()), ay = std::abs(d.y()), az = std::abs(d.z());
  std::uint32_t face;
  float m, u, v;
  if (ax >= ay && ax >= az) {
    face = d.x() > 0 ? 0 : 1, m = ax, u = d.y(), v = d.z();
  } else if (ay >= az) {
    face = d.y() > 0 ? 2 : 3, m = ay, u = d.x(), v = d.z();
  } else {
    face = d.z() > 0 ? 4 : 5, m = az, u = d.x(), v = d.y();
  }
  const float scale = 0.5f * static_cast<float>(size) / m, half = 0.5f * static_cast<float>(size);
  const auto column = std::min(static_cast<std::uint32_t>(u * scale + half), size - 1);
  const auto row = std::min(static_cast<std::uint32_t>(v * scale + half), size - 1);
  return (face * size + row) * size + column;
}

/// The image at the finest resolution (its own, half, a quarter, an eighth) at which most cells beside a return hold
/// one too: a thinned or sparse scan does not see between its beams. size must be a multiple of 8.
FreeSpace at_scan_resolution(const FreeSpace& raw);

/// The image at cells of at least `cell_rad`, but no fewer than 8 a face's side.
FreeSpace at_least_cells_of(const FreeSpace& image, double cell_rad);

/// Minimum over each cell and its neighbours on the same face; a cell without returns stays empty unless at least three
/// neighbours have one (thinned scans leave holes). `nearest_m` as accumulated from raw points: +inf = nothing.
FreeSpace dilated_free_space(const FreeSpace& raw);

}  // namespace isthmus
