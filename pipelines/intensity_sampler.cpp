#include "pipelines/intensity_sampler.h"

#include <cmath>

namespace isthmus::pipelines {

std::uint64_t IntensitySampler::key_of(const Eigen::Vector3f& p) const {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) {
    const auto cell = static_cast<std::int64_t>(std::floor(static_cast<double>(p[k]) / cell_m_));
    key = key << 21 | (static_cast<std::uint64_t>(cell) & kMask);
  }
  return key;
}

void IntensitySampler::add(const PointChunk& chunk) {
  constexpr std::uint64_t kStride = 3;
  if (chunk.intensity.size() != chunk.points.size()) complete_ = false;
  if (!complete_) return;
  for (std::size_t i = 0; i < chunk.points.size(); ++i) {
    if (next_++ % kStride != 0 || !chunk.points[i].allFinite() || !std::isfinite(chunk.intensity[i])) continue;
    for (Sum* sum : {&sums_[key_of(chunk.points[i])], &all_}) {
      sum->intensity += static_cast<double>(chunk.intensity[i]);
      ++sum->count;
    }
  }
}

std::vector<float> IntensitySampler::of(const SampledScan& scan) const {
  std::vector<float> out;
  if (!complete_ || all_.count == 0) return out;
  const auto& points = scan.fine.points.empty() ? scan.points : scan.fine.points;
  out.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    const auto at = sums_.find(key_of(p));
    const Sum& sum = at == sums_.end() ? all_ : at->second;
    out.push_back(static_cast<float>(sum.intensity / sum.count));
  }
  return out;
}

}  // namespace isthmus::pipelines
