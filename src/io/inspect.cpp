#include "io/inspect.h"

#include <algorithm>
#include <cmath>

#include "io/format_table.h"
#include "io/spacing.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kAnchors = 256;
constexpr std::size_t kChunkPoints = std::size_t{1} << 15;

struct Extent {
  Eigen::AlignedBox3f box_in_local;
  std::uint64_t num_finite = 0;

  void add(const PointChunk& chunk) {
    for (const Eigen::Vector3f& p : chunk.points) {
      if (!p.allFinite()) continue;
      box_in_local.extend(p);
      ++num_finite;
    }
  }
};

void widen(std::optional<std::pair<float, float>>& range, const std::vector<float>& values) {
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    if (!range) range = {value, value};
    range->first = std::min(range->first, value);
    range->second = std::max(range->second, value);
  }
}

}  // namespace

Result<ScanSummary> inspect_scan(const ScanRef& scan) {
  auto reader = open_probing(scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  auto anchors = (*reader)->probe(kAnchors);
  if (!anchors) return tl::unexpected(std::move(anchors.error()));
  SpacingEstimator spacing(*anchors);
  ScanSummary summary;
  Extent extent;
  for (PointChunk chunk;;) {
    auto read = (*reader)->read(chunk, kChunkPoints);
    if (!read) return tl::unexpected(std::move(read.error()));
    if (chunk.points.empty()) break;
    summary.num_read += chunk.points.size();
    extent.add(chunk);
    spacing.add(chunk);
    widen(summary.intensity_range, chunk.intensity);
  }
  summary.header = (*reader)->header();
  summary.num_finite = extent.num_finite;
  summary.spacing_m = spacing.median();
  if (extent.num_finite > 0) {
    const Eigen::Vector3d origin = summary.header.local_origin_in_scan;
    summary.extent_in_scan = Eigen::AlignedBox3d(extent.box_in_local.min().cast<double>() + origin,
                                                 extent.box_in_local.max().cast<double>() + origin);
  }
  return summary;
}

}  // namespace isthmus::io
