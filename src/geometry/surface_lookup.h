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

  /// Index of a point near `p`, or -1. Without branches, so that many lookups may wait for memory at once.
  [[nodiscard]] std::int32_t near(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f g = (p - low_) * inverse_cell_;
    const bool inside = bool(g.x() >= 0) & bool(g.y() >= 0) & bool(g.z() >= 0) & bool(g.x() < end_.x()) &
                        bool(g.y() < end_.y()) & bool(g.z() < end_.z());
    const std::uint32_t x = cell_of(g.x(), end_.x()), y = cell_of(g.y(), end_.y()), z = cell_of(g.z(), end_.z());
    const std::size_t of_block = (static_cast<std::size_t>(z >> 3) * size_[1] + (y >> 3)) * size_[0] + (x >> 3);
    const auto block = static_cast<std::size_t>(blocks_[inside ? of_block : nowhere_]);
    return cells_[block * 512 + ((z & 7u) << 6 | (y & 7u) << 3 | (x & 7u))];
  }
  [[nodiscard]] std::size_t bytes() const { return blocks_.size() * 4 + cells_.size() * 4; }

 private:
  static std::uint32_t cell_of(float g, float end) {
    const float within = g > 0 ? g : 0;  // NaN is 0
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(within < end ? within : 0));
  }

  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  float inverse_cell_ = 1;
  Eigen::Vector3f end_ = Eigen::Vector3f::Zero();  // of the grid, in cells
  std::array<std::uint32_t, 3> size_{0, 0, 0};     // in blocks
  std::size_t nowhere_ = 0;                        // the last of blocks_: for what lies outside
  std::vector<std::int32_t> blocks_{0};            // where its cells are; block 0 is empty
  std::vector<std::int32_t> cells_ = std::vector<std::int32_t>(512, -1);
};

}  // namespace isthmus
