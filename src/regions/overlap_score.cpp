#include "regions/overlap_score.h"

#include <array>

#include "regions/lookups.h"

namespace isthmus {
namespace {

constexpr float kMinFacing = 0.5f;            // cosine: the two surfaces face the same way within 60 degrees
constexpr float kFreeToleranceVoxels = 1.5f;  // method.md, facts

// p: point i of `from` in the frame of `to`; j: a point of `to` near it, or -1.
PointVerdict judge(const ScanModel& from, const ScanModel& to, const Pose3f& to_from, std::size_t i,
                   const Eigen::Vector3f& p, std::int32_t j, float tolerance_m) {
  if (j < 0) return to.seen_through(p, tolerance_m) ? PointVerdict::contradicted : PointVerdict::neutral;
  const float facing = to.normals[j].dot(to_from.rotation * from.normals[i]);
  if (facing > kMinFacing) return PointVerdict::supported;
  return facing < -kMinFacing ? PointVerdict::against : PointVerdict::neutral;
}

const SurfaceLookup& lookup_of(const ScanModel& to, bool coarse) { return coarse ? to.coarse : to.fine; }
float tolerance_of(const ScanModel& to, bool coarse) {
  return kFreeToleranceVoxels * to.voxel_m * (coarse ? 2.0f : 1.0f);
}

using Counts = std::array<std::size_t, 4>;  // by verdict
DirectedScore shares_of(const Counts& counts, std::size_t tried) {
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

}  // namespace

PointVerdicts judge_points(const ScanModel& from, const ScanModel& to, const Pose3f& to_from,
                           std::span<const std::uint32_t> sample, bool coarse) {
  PointVerdicts out(sample.size());
  for_each_lookup(from, to, lookup_of(to, coarse), to_from, sample,
                  [&](std::size_t k, const Eigen::Vector3f& p, std::int32_t j) {
                    out[k] = judge(from, to, to_from, sample[k], p, j, tolerance_of(to, coarse));
                  });
  return out;
}

DirectedScore shares_of(const PointVerdicts& verdicts) {
  Counts counts{};
  for (const PointVerdict v : verdicts) ++counts[static_cast<std::size_t>(v)];
  return shares_of(counts, verdicts.size());
}

DirectedScore score_direction(const ScanModel& from, const ScanModel& to, const Pose3f& to_from,
                              std::span<const std::uint32_t> sample, std::size_t stride, bool coarse) {
  const std::size_t n = sample.empty() ? from.points.size() : sample.size();
  const std::size_t tried = (n + stride - 1) / stride;
  Counts counts{};
  const auto index_of = [&](std::size_t k) { return sample.empty() ? k * stride : sample[k * stride]; };
  for_each_lookup(from, to, lookup_of(to, coarse), to_from, tried, index_of,
                  [&](std::size_t k, const Eigen::Vector3f& p, std::int32_t j) {
                    const PointVerdict v = judge(from, to, to_from, index_of(k), p, j, tolerance_of(to, coarse));
                    ++counts[static_cast<std::size_t>(v)];
                  });
  return shares_of(counts, tried);
}

}  // namespace isthmus
