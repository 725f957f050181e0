// Constant-time "which surface point is near here": a sparse grid whose cells remember the nearest point within reach.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace isthmus {

/// Cells of edge `cell_m` in blocks of 8 x 8 x 8, allocated only near points. A cell knows the indexed point nearest to
/// its centre among those within reach_cells + 0.5 cells of it, so a lookup costs two memory reads. The query lies
/// within half a cell diagonal of that centre: the answer is at most a whole diagonal farther than the nearest point.
/// Deterministic; ties go to the smaller index.
class SurfaceLookup {
 public:
  SurfaceLookup() = default;
  /// Points must be finite. reach_cells >= 1.
  SurfaceLookup(std::span<const Eigen::Vector3f> points, float cell_m, int reach_cells);

  /// Index of a point near `p`, or -1.
  [[nodiscard]] std::int32_t near(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f g = (p - low_) * inverse_cell_;
    if (!(g.x() >= 0 && g.y() >= 0 && g.z() >= 0)) return -1;
    const auto x = static_cast<std::uint32_t>(g.x()), y = static_cast<std::uint32_t>(g.y()),
               z = static_cast<std::uint32_t>(g.z());
    const std::uint32_t bx = x >> 3, by = y >> 3, bz = z >> 3;
    if (bx >= size_[0] || by >= size_[1] || bz >= size_[2]) return -1;
    const std::int32_t block = blocks_[(static_cast<std::size_t>(bz) * size_[1] + by) * size_[0] + bx];
    if (block < 0) return -1;
    return cells_[static_cast<std::size_t>(block) * 512 + ((z & 7u) << 6 | (y & 7u) << 3 | (x & 7u))];
  }
  [[nodiscard]] std::size_t bytes() const { return blocks_.size() * 4 + cells_.size() * 4; }

 private:
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  float inverse_cell_ = 1;
  std::array<std::uint32_t, 3> size_{0, 0, 0};  // in blocks
  std::vector<std::int32_t> blocks_;
  std::vector<std::int32_t> cells_;
};

}  // namespace isthmus
