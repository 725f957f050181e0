#include "io/spacing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus::io {
namespace {

constexpr double kCellQuantile = 0.9;  // of the distances between anchors: most true neighbours are far nearer

float quantile(std::vector<float> values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

}  // namespace

SpacingEstimator::SpacingEstimator(const PointChunk& anchors) {
  for (const Eigen::Vector3f& p : anchors.points) {
    if (p.allFinite() && !p.isZero(0.0F)) anchors_.push_back(p);
  }
  sq_nearest_.assign(anchors_.size(), std::numeric_limits<float>::infinity());
  std::vector<float> between;  // distance of each anchor to the nearest other one
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    float sq = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& other : anchors_) {
      const float sq_other = (anchors_[i] - other).squaredNorm();
      if (sq_other > 0.0F) sq = std::min(sq, sq_other);
    }
    if (std::isfinite(sq)) between.push_back(std::sqrt(sq));
  }
  if (between.empty()) return;
  cell_m_ = quantile(between, kCellQuantile);
  for (std::uint32_t i = 0; i < anchors_.size(); ++i) {
    for (int n = 0; n < 27; ++n) {
      anchors_near_cell_[cell_of(anchors_[i], n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1)].push_back(i);
    }
  }
}

// 21 bits per axis; cells so far apart that they fall together cost a comparison, no more.
std::uint64_t SpacingEstimator::cell_of(const Eigen::Vector3f& p, int dx, int dy, int dz) const {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  constexpr double kFarthest = 1e15;  // beyond it a cell index would not fit
  const auto index = [&](float value, int shift) {
    const double cell = std::clamp(std::floor(static_cast<double>(value) / cell_m_), -kFarthest, kFarthest);
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell) + shift) & kMask;
  };
  return index(p.x(), dx) << 42 | index(p.y(), dy) << 21 | index(p.z(), dz);
}

void SpacingEstimator::add(const PointChunk& chunk) {
  if (cell_m_ <= 0.0F) return;
  for (const Eigen::Vector3f& p : chunk.points) {
    if (!p.allFinite()) continue;
    const auto near = anchors_near_cell_.find(cell_of(p, 0, 0, 0));
    if (near == anchors_near_cell_.end()) continue;
    for (const std::uint32_t i : near->second) {
      const float sq = (p - anchors_[i]).squaredNorm();
      if (sq > 0.0F && sq < sq_nearest_[i]) sq_nearest_[i] = sq;
    }
  }
}

std::optional<double> SpacingEstimator::median() const {
  std::vector<float> found;
  for (const float sq : sq_nearest_) {
    if (std::sqrt(sq) <= cell_m_) found.push_back(std::sqrt(sq));
  }
  if (found.empty()) return std::nullopt;
  return quantile(found, 0.5);
}

}  // namespace isthmus::io
