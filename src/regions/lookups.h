// Many lookups of moved points at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "regions/overlap_score.h"
#include "regions/scan_model.h"

namespace isthmus {

/// Calls f(k, p, j) for k = 0 .. count - 1: p is point index_of(k) of `from` in the frame of `to`, j a point of `to`
/// near it or -1. The lookups of a batch come first, so that their reads of memory overlap.
template <class IndexOf, class F>
void for_each_lookup(const ScanModel& from, const ScanModel& to, const SurfaceLookup& lookup, const Pose3f& to_from,
                     std::size_t count, IndexOf&& index_of, F&& f) {
  constexpr std::size_t kBatch = 32;
  std::array<Eigen::Vector3f, kBatch> moved;
  std::array<std::int32_t, kBatch> near{};
  for (std::size_t first = 0; first < count; first += kBatch) {
    const std::size_t n = std::min(kBatch, count - first);
    for (std::size_t b = 0; b < n; ++b) {
      moved[b] = to_from * from.points[index_of(first + b)];
      near[b] = lookup.near(moved[b]);
    }
    for (std::size_t b = 0; b < n; ++b) {
      const auto j = static_cast<std::size_t>(std::max(near[b], 0));
      __builtin_prefetch(to.normals.data() + j);
      __builtin_prefetch(to.points.data() + j);
    }
    for (std::size_t b = 0; b < n; ++b) f(first + b, moved[b], near[b]);
  }
}

/// The same for the points that `sample` names.
template <class F>
void for_each_lookup(const ScanModel& from, const ScanModel& to, const SurfaceLookup& lookup, const Pose3f& to_from,
                     std::span<const std::uint32_t> sample, F&& f) {
  for_each_lookup(
      from, to, lookup, to_from, sample.size(), [&](std::size_t k) { return sample[k]; }, f);
}

}  // namespace isthmus
