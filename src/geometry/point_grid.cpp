#include "geometry/point_grid.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace isthmus {
namespace {

std::uint64_t mixed(std::uint64_t key) {
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccdULL;
  key ^= key >> 33;
  return key;
}

}  // namespace

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points, float cell_m)
    : points_(points), inverse_cell_(1.0f / cell_m), order_(points.size()) {
  std::vector<std::uint64_t> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto c = cell_of(points[i]);
    keys[i] = key_of(c[0], c[1], c[2]);
  }
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
  std::size_t num_cells = 0;
  for (std::size_t k = 0; k < order_.size(); ++k)
    if (k == 0 || keys[order_[k]] != keys[order_[k - 1]]) ++num_cells;
  std::size_t capacity = 16;
  while (capacity < 2 * num_cells) capacity *= 2;
  mask_ = capacity - 1;
  slots_.assign(capacity, 0);
  runs_.assign(capacity, {0, 0});
  for (std::uint32_t k = 0; k < order_.size();) {
    std::uint32_t end = k + 1;
    const std::uint64_t key = keys[order_[k]];
    while (end < order_.size() && keys[order_[end]] == key) ++end;
    std::uint64_t slot = mixed(key) & mask_;
    while (slots_[slot] != 0) slot = (slot + 1) & mask_;
    slots_[slot] = key + 1;
    runs_[slot] = {k, end};
    k = end;
  }
}

std::pair<std::uint32_t, std::uint32_t> PointGrid::run_of(std::uint64_t key) const {
  for (std::uint64_t slot = mixed(key) & mask_; slots_[slot] != 0; slot = (slot + 1) & mask_)
    if (slots_[slot] == key + 1) return runs_[slot];
  return {0, 0};
}

std::pair<std::int64_t, float> PointGrid::nearest_within(const Eigen::Vector3f& query, float radius_m) const {
  std::int64_t best = -1;
  float best_sq = std::numeric_limits<float>::infinity();
  for_each_within(query, radius_m, [&](std::uint32_t i, float sq) {
    if (sq < best_sq || (sq == best_sq && i < best)) {
      best_sq = sq;
      best = i;
    }
  });
  return {best, best_sq};
}

}  // namespace isthmus
