#include "regions/grow.h"

#include <algorithm>
#include <cmath>

#include "regions/align.h"

namespace isthmus {
namespace {

// Up to `max_points` source indices spread over the scan, nearest to `centre` first.
std::vector<std::uint32_t> by_distance(const ScanModel& model, const Eigen::Vector3f& centre, std::size_t max_points,
                                       std::vector<float>& distance) {
  const std::size_t n = model.points.size(), count = std::min(n, max_points);
  std::vector<std::pair<float, std::uint32_t>> order(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::uint32_t>(k * n / count);
    order[k] = {(model.points[i] - centre).norm(), i};
  }
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> sorted(count);
  distance.resize(count);
  for (std::size_t k = 0; k < count; ++k) distance[k] = order[k].first, sorted[k] = order[k].second;
  return sorted;
}

}  // namespace

float ranking_score(const DirectedScore& a, const DirectedScore& b) {
  constexpr float kContradictionWeight = 5;
  return std::min(a.support, b.support) + 0.25f * std::max(a.support, b.support) -
         kContradictionWeight * 0.5f * (a.contradiction + b.contradiction);
}

GrownOverlap grow(const ScanModel& source, const ScanModel& target, const Seed& seed, const GrowOptions& options) {
  const Eigen::Vector3f centre = source.regions.regions[seed.source_region].centre;
  std::vector<float> distance;
  // Denser near the seed: half of the budget goes to its surroundings.
  const std::vector<std::uint32_t> sample = by_distance(source, centre, 4 * options.max_points, distance);
  const Pose3f start = seed.target_from_source(source);
  Transform t = Transform::Identity();
  t.linear() = start.rotation.cast<double>();
  t.translation() = start.translation.cast<double>();
  GrownOverlap out;
  const float voxel = source.voxel_m;
  float radius = options.start_radius_voxels * voxel;
  const float whole = distance.empty() ? 0.0f : distance.back();
  int finals = options.final_steps;
  for (int step = 0; finals > 0; ++step, radius *= options.growth) {
    const bool covers_all = radius >= whole;
    if (covers_all) --finals;
    const auto n =
        static_cast<std::size_t>(std::upper_bound(distance.begin(), distance.end(), radius) - distance.begin());
    std::vector<std::uint32_t> part;
    const std::size_t stride = std::max<std::size_t>(1, n / options.max_points);
    for (std::size_t k = 0; k < n; k += stride) part.push_back(sample[k]);
    const bool coarse = step < 3 || (!covers_all && step < 5);
    const Eigen::Vector3d middle = t * centre.cast<double>();
    NormalEquations equations;
    add_point_to_plane(source, target, t, part, coarse, (coarse ? 2.5f : 1.2f) * voxel, middle, equations);
    constexpr std::size_t kMinMatches = 12;
    if (equations.matches < kMinMatches) break;
    t = solved_step(equations, middle, voxel) * t;
    out.matches = equations.matches;
    out.rms_m = std::sqrt(equations.sq_residual_sum / std::max(equations.weight, 1e-12));
  }
  out.target_from_source = orthonormalised(t);
  const Pose3f pose{out.target_from_source.linear().cast<float>(), out.target_from_source.translation().cast<float>()};
  const auto stride = [](const ScanModel& m) { return std::max<std::size_t>(1, m.points.size() / 1200); };
  out.source_in_target = score_direction(source, target, pose, {}, stride(source), false);
  out.target_in_source = score_direction(target, source, pose.inverse(), {}, stride(target), false);
  out.score = ranking_score(out.source_in_target, out.target_in_source);
  return out;
}

}  // namespace isthmus
