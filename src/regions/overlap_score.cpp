#include "regions/overlap_score.h"

namespace isthmus {
namespace {

constexpr float kMinFacing = 0.5f;            // cosine: the two surfaces face the same way within 60 degrees
constexpr float kFreeToleranceVoxels = 1.5f;  // method.md, facts

PointVerdict judge(const ScanModel& from, const ScanModel& to, const Pose3f& to_from, std::size_t i,
                   const SurfaceLookup& lookup, float tolerance_m) {
  const Eigen::Vector3f p = to_from * from.points[i];
  const std::int32_t j = lookup.near(p);
  if (j < 0) return to.seen_through(p, tolerance_m) ? PointVerdict::contradicted : PointVerdict::neutral;
  const float facing = to.normals[j].dot(to_from.rotation * from.normals[i]);
  if (facing > kMinFacing) return PointVerdict::supported;
  return facing < -kMinFacing ? PointVerdict::against : PointVerdict::neutral;
}

const SurfaceLookup& lookup_of(const ScanModel& to, bool coarse) { return coarse ? to.coarse : to.fine; }
float tolerance_of(const ScanModel& to, bool coarse) {
  return kFreeToleranceVoxels * to.voxel_m * (coarse ? 2.0f : 1.0f);
}

}  // namespace

PointVerdicts judge_points(const ScanModel& from, const ScanModel& to, const Pose3f& to_from,
                           std::span<const std::uint32_t> sample, bool coarse) {
  PointVerdicts out(sample.size());
  for (std::size_t k = 0; k < sample.size(); ++k)
    out[k] = judge(from, to, to_from, sample[k], lookup_of(to, coarse), tolerance_of(to, coarse));
  return out;
}

DirectedScore score_direction(const ScanModel& from, const ScanModel& to, const Pose3f& to_from,
                              std::span<const std::uint32_t> sample, std::size_t stride, bool coarse) {
  const std::size_t n = sample.empty() ? from.points.size() : sample.size();
  std::size_t tried = 0, counts[4] = {0, 0, 0, 0};
  for (std::size_t k = 0; k < n; k += stride, ++tried) {
    const std::size_t i = sample.empty() ? k : sample[k];
    ++counts[static_cast<std::size_t>(judge(from, to, to_from, i, lookup_of(to, coarse), tolerance_of(to, coarse)))];
  }
  DirectedScore out;
  if (tried == 0) return out;
  const auto share = [&](PointVerdict v) {
    return static_cast<float>(counts[static_cast<std::size_t>(v)]) / static_cast<float>(tried);
  };
  out.support = share(PointVerdict::supported);
  out.contradiction = share(PointVerdict::contradicted);
  out.against = share(PointVerdict::against);
  return out;
}

}  // namespace isthmus
