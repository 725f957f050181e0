#include "geometry/surface_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

// A grid of blocks is dense; far outliers are left out rather than letting it grow beyond this.
constexpr std::size_t kMaxBlocks = std::size_t{1} << 22;

struct Box {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Vector3f high = Eigen::Vector3f::Constant(-std::numeric_limits<float>::infinity());
};

std::size_t num_blocks(const Box& box, float cell_m) {
  std::size_t n = 1;
  for (int a = 0; a < 3; ++a) n *= static_cast<std::size_t>((box.high[a] - box.low[a]) / (8 * cell_m)) + 1;
  return n;
}

}  // namespace

SurfaceLookup::SurfaceLookup(std::span<const Eigen::Vector3f> points, float cell_m, int reach_cells)
    : inverse_cell_(1.0f / cell_m) {
  if (points.empty()) return;
  Box box;
  for (const auto& p : points) box.low = box.low.cwiseMin(p), box.high = box.high.cwiseMax(p);
  const float margin = cell_m * static_cast<float>(reach_cells + 1);
  box.low.array() -= margin, box.high.array() += margin;
  if (num_blocks(box, cell_m) > kMaxBlocks) {  // keep the central 99.8 % along each axis
    std::vector<float> values(points.size());
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
      std::sort(values.begin(), values.end());
      box.low[a] = values[values.size() / 1000] - margin;
      box.high[a] = values[values.size() - 1 - values.size() / 1000] + margin;
    }
  }
  while (num_blocks(box, cell_m) > kMaxBlocks) {  // still too wide: shrink towards the middle
    const Eigen::Vector3f middle = 0.5f * (box.low + box.high), half = 0.4f * (box.high - box.low);
    box.low = middle - half, box.high = middle + half;
  }
  low_ = box.low;
  for (int a = 0; a < 3; ++a) size_[a] = static_cast<std::uint32_t>((box.high[a] - box.low[a]) * inverse_cell_ / 8) + 1;
  end_ = 8 * Eigen::Vector3f(static_cast<float>(size_[0]), static_cast<float>(size_[1]), static_cast<float>(size_[2]));
  nowhere_ = static_cast<std::size_t>(size_[0]) * size_[1] * size_[2];
  blocks_.assign(nowhere_ + 1, 0);
  std::vector<float> nearest(512);             // squared, of each cell
  std::array<std::vector<float>, 3> sq_along;  // of the cells' centres about a point, along each axis
  for (auto& of_axis : sq_along) of_axis.resize(2 * static_cast<std::size_t>(reach_cells) + 1);
  const Eigen::Array3i limit = end_.array().cast<int>();
  const float reach_m = cell_m * (static_cast<float>(reach_cells) + 0.5f), sq_reach = reach_m * reach_m;
  const float beyond_reach = std::nextafter(sq_reach, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f g = (points[i] - low_) * inverse_cell_;
    if (!((g.array() >= 0).all()) || !((g.array() < end_.array()).all())) continue;
    const Eigen::Array3i c = g.array().floor().cast<int>();
    const Eigen::Array3i from = (c - reach_cells).max(0), to = (c + reach_cells).min(limit - 1);
    for (int a = 0; a < 3; ++a)
      for (int k = from[a]; k <= to[a]; ++k) {
        const float d = points[i][a] - (low_[a] + cell_m * (static_cast<float>(k) + 0.5f));
        sq_along[a][static_cast<std::size_t>(k - from[a])] = d * d;
      }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y) {
        const float sq_yz =
            sq_along[1][static_cast<std::size_t>(y - from[1])] + sq_along[2][static_cast<std::size_t>(z - from[2])];
        if (sq_yz > sq_reach) continue;
        std::int32_t* const row = &blocks_[(static_cast<std::size_t>(z >> 3) * size_[1] + (y >> 3)) * size_[0]];
        for (int x = from[0]; x <= to[0];) {
          const int end = std::min(to[0], x | 7) + 1;  // of the block
          std::int32_t& block = row[x >> 3];
          if (block == 0) {
            block = static_cast<std::int32_t>(cells_.size() / 512);
            cells_.resize(cells_.size() + 512, -1);
            nearest.resize(cells_.size(), beyond_reach);
          }
          const std::size_t k = static_cast<std::size_t>(block) * 512 + ((z & 7) << 6 | (y & 7) << 3);
          for (; x < end; ++x) {
            const float sq_distance = sq_yz + sq_along[0][static_cast<std::size_t>(x - from[0])];
            float& so_far = nearest[k + static_cast<std::size_t>(x & 7)];
            if (sq_distance >= so_far) continue;
            so_far = sq_distance;
            cells_[k + static_cast<std::size_t>(x & 7)] = static_cast<std::int32_t>(i);
          }
        }
      }
  }
}

}  // namespace isthmus
