// Radius neighbours over a fixed set of points: a hash grid whose cells hold consecutive runs of indices.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace isthmus {

/// Keeps a reference to `points`; they must outlive the grid. Queries visit cells in a fixed order and indices of a
/// cell in ascending order, so sums over neighbours are the same on every run. Points must be finite.
class PointGrid {
 public:
  PointGrid(std::span<const Eigen::Vector3f> points, float cell_m);

  /// visit(index, squared distance in m2) for every point within radius_m of `query` (the query itself included if
  /// indexed).
  template <class Visit>
  void for_each_within(const Eigen::Vector3f& query, float radius_m, Visit&& visit) const {
    const float sq_radius = radius_m * radius_m;
    const auto low = cell_of(query - Eigen::Vector3f::Constant(radius_m));
    const auto high = cell_of(query + Eigen::Vector3f::Constant(radius_m));
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto [begin, end] = run_of(key_of(x, y, z));
          for (std::uint32_t k = begin; k < end; ++k) {
            const float sq_distance = (points_[order_[k]] - query).squaredNorm();
            if (sq_distance <= sq_radius) visit(order_[k], sq_distance);
          }
        }
  }

  /// Index and squared distance of the nearest point within radius_m, or {-1, inf}; ties go to the smaller index.
  [[nodiscard]] std::pair<std::int64_t, float> nearest_within(const Eigen::Vector3f& query, float radius_m) const;

 private:
  [[nodiscard]] Eigen::Matrix<std::int64_t, 3, 1> cell_of(const Eigen::Vector3f& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() * inverse_cell_)),
            static_cast<std::int64_t>(std::floor(p.y() * inverse_cell_)),
            static_cast<std::int64_t>(std::floor(p.z() * inverse_cell_))};
  }
  static std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr std::int64_t kOffset = 1 << 20;  // 2^21 cells a side: 200 km of 0.1 m cells
    return (static_cast<std::uint64_t>(x + kOffset) << 42) ^ (static_cast<std::uint64_t>(y + kOffset) << 21) ^
           static_cast<std::uint64_t>(z + kOffset);
  }
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> run_of(std::uint64_t key) const;

  std::span<const Eigen::Vector3f> points_;
  float inverse_cell_;
  std::vector<std::uint32_t> order_;  // point indices grouped by cell
  std::vector<std::uint64_t> slots_;  // open addressing: key + 1, 0 = empty
  std::vector<std::pair<std::uint32_t, std::uint32_t>> runs_;
  std::uint64_t mask_ = 0;
};

}  // namespace isthmus
