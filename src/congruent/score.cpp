#include "congruent/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isthmus::congruent {
namespace {

constexpr float kSpare = 1.0001F;  // cells reach a little further than the tolerance, for rounding

// Squared distance from a point to the box of a cell.
float sq_distance_to_cell(const Eigen::Vector3f& p, const Eigen::Vector3i& cell, float edge) {
  const Eigen::Vector3f low = cell.cast<float>() * edge;
  return (low - p).cwiseMax(p - low - Eigen::Vector3f::Constant(edge)).cwiseMax(0.0F).squaredNorm();
}

}  // namespace

FacingGrid::FacingGrid(const LocalCloud& target, double tolerance_m, double facing_tolerance_rad)
    : points_(target.points),
      normals_(target.normals),
      sq_tolerance_(static_cast<float>(tolerance_m) * static_cast<float>(tolerance_m)),
      inverse_edge_(1 / static_cast<float>(tolerance_m)),
      min_cosine_(static_cast<float>(std::cos(facing_tolerance_rad))) {
  const auto edge = static_cast<float>(tolerance_m);
  std::vector<CellKey> keys;
  std::vector<std::uint32_t> point_of_key, order;
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3i home = cell_of(points_[i], inverse_edge_);
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i cell = home + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if (sq_distance_to_cell(points_[i], cell, edge) > sq_tolerance_ * kSpare) continue;
      keys.push_back(cell_key(cell));
      point_of_key.push_back(i);
    }
  }
  cells_ = CellTable(keys, order);
  entries_.reserve(order.size());
  for (const std::uint32_t k : order) entries_.push_back(point_of_key[k]);
}

CellRange FacingGrid::cell_at(const Eigen::Vector3f& point) const {
  // A point carried far outside has no cell (and its cell number might not fit an int).
  if (!((point * inverse_edge_).cwiseAbs().maxCoeff() < kMaxCells)) return {};
  return cells_.find(cell_key(cell_of(point, inverse_edge_)));
}

bool FacingGrid::has_facing(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
  const CellRange range = cell_at(point);
  for (std::uint32_t e = range.begin; e < range.end; ++e)
    if ((points_[entries_[e]] - point).squaredNorm() <= sq_tolerance_ && faces(entries_[e], normal)) return true;
  return false;
}

std::optional<std::uint32_t> FacingGrid::nearest_facing(const Eigen::Vector3f& point,
                                                        const Eigen::Vector3f& normal) const {
  const CellRange range = cell_at(point);
  std::optional<std::uint32_t> nearest;
  float sq_nearest = sq_tolerance_;
  for (std::uint32_t e = range.begin; e < range.end; ++e) {
    const std::uint32_t i = entries_[e];
    const float sq_distance = (points_[i] - point).squaredNorm();
    if ((sq_distance < sq_nearest || (!nearest && sq_distance <= sq_nearest)) && faces(i, normal))
      nearest = i, sq_nearest = sq_distance;
  }
  return nearest;
}

ScoreSample draw_sample(const LocalCloud& source, std::size_t size, Rng& rng) {
  std::vector<std::uint32_t> order(source.points.size());
  std::iota(order.begin(), order.end(), 0U);
  size = std::min(size, order.size());
  ScoreSample sample;
  for (std::size_t i = 0; i < size; ++i) {  // Fisher and Yates, as far as needed
    std::swap(order[i], order[i + rng.below(order.size() - i)]);
    sample.points.push_back(source.points[order[i]]);
    if (!source.normals.empty()) sample.normals.push_back(source.normals[order[i]]);
  }
  return sample;
}

std::optional<std::int64_t> count_leading(const FacingGrid& target, const ScoreSample& sample, std::size_t size,
                                          const Transform& target_from_source, std::int64_t to_beat,
                                          ScoreCounts& counts) {
  const Eigen::Matrix3f rotation = target_from_source.linear().cast<float>();
  const Eigen::Vector3f translation = target_from_source.translation().cast<float>();
  const bool oriented = !sample.normals.empty();
  auto left = static_cast<std::int64_t>(std::min(size, sample.points.size()));
  std::int64_t common = 0;
  for (std::size_t i = 0; left > 0 && common + left > to_beat; ++i, --left) {
    ++counts.points_looked_up;
    const Eigen::Vector3f normal = oriented ? (rotation * sample.normals[i]).eval() : Eigen::Vector3f::Zero().eval();
    if (target.has_facing(rotation * sample.points[i] + translation, normal)) ++common;
  }
  if (common <= to_beat) return std::nullopt;
  return common;
}

std::optional<std::int64_t> count_common(const FacingGrid& target, const ScoreSample& sample,
                                         const Transform& target_from_source, std::int64_t to_beat,
                                         ScoreCounts& counts) {
  return count_leading(target, sample, sample.points.size(), target_from_source, to_beat, counts);
}

}  // namespace isthmus::congruent
