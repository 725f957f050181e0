// Point spacing while streaming: exact nearest-neighbour distances of a few anchors, whatever the number of points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "io/scan_reader.h"

namespace isthmus::io {

/// Anchors are points of the scan (from a probe); every streamed point is compared with the anchors near it only. The
/// anchors themselves and duplicates of them (distance zero) do not count.
class SpacingEstimator {
 public:
  explicit SpacingEstimator(const PointChunk& anchors);
  void add(const PointChunk& chunk);
  /// Median over the anchors that have a neighbour within the anchors' own spacing; absent if none has.
  [[nodiscard]] std::optional<double> median() const;

 private:
  [[nodiscard]] std::uint64_t cell_of(const Eigen::Vector3f& p, int dx, int dy, int dz) const;

  std::vector<Eigen::Vector3f> anchors_;
  std::vector<float> sq_nearest_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> anchors_near_cell_;
  float cell_m_ = 0.0F;  // 0: fewer than two different anchors
};

}  // namespace isthmus::io
