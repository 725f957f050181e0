#include "regions/grow.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "regions/align.h"

namespace isthmus {

float ranking_score(const DirectedScore& a, const DirectedScore& b) {
  constexpr float kContradictionWeight = 5;
  return std::min(a.support, b.support) + 0.25f * std::max(a.support, b.support) -
         kContradictionWeight * 0.5f * (a.contradiction + b.contradiction);
}

namespace {

// Source points spread over the scan, nearest to a region's centre first.
struct GrowthOrder {
  std::vector<std::uint32_t> points;
  std::vector<float> distance_m;
};

GrowthOrder growth_order(const ScanModel& source, std::uint32_t region, const GrowOptions& options) {
  const Eigen::Vector3f& centre = source.regions.regions[region].centre;
  // Denser near the seed: half of the budget goes to its surroundings.
  const std::size_t n = source.points.size(), count = std::min(n, 4 * options.max_points);
  std::vector<std::pair<float, std::uint32_t>> sorted(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::uint32_t>(k * n / count);
    sorted[k] = {(source.points[i] - centre).norm(), i};
  }
  std::sort(sorted.begin(), sorted.end());
  GrowthOrder order;
  for (const auto& [distance_m, i] : sorted) order.points.push_back(i), order.distance_m.push_back(distance_m);
  return order;
}

GrownOverlap grow_in_order(const ScanModel& source, const ScanModel& target, const Seed& seed, const GrowthOrder& order,
                           const GrowOptions& options) {
  const Eigen::Vector3f centre = source.regions.regions[seed.source_region].centre;
  const std::vector<float>& distance = order.distance_m;
  Transform t = transform_of(seed.target_from_source(source));
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
    for (std::size_t k = 0; k < n; k += stride) part.push_back(order.points[k]);
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
  const Pose3f pose = pose3f(out.target_from_source);
  const auto stride = [](const ScanModel& m) { return std::max<std::size_t>(1, m.points.size() / 1200); };
  out.source_in_target = score_direction(source, target, pose, {}, stride(source), false);
  out.target_in_source = score_direction(target, source, pose.inverse(), {}, stride(target), false);
  out.score = ranking_score(out.source_in_target, out.target_in_source);
  return out;
}

}  // namespace

GrownOverlap grow(const ScanModel& source, const ScanModel& target, const Seed& seed, const GrowOptions& options) {
  return grow_in_order(source, target, seed, growth_order(source, seed.source_region, options), options);
}

std::vector<GrownOverlap> grow_all(const ScanModel& source, const ScanModel& target, std::span<const Seed> seeds,
                                   const GrowOptions& options) {
  std::vector<GrowthOrder> orders(source.regions.regions.size());
  std::vector<std::uint32_t> grown_from;
  for (const Seed& s : seeds) grown_from.push_back(s.source_region);
  std::sort(grown_from.begin(), grown_from.end());
  grown_from.erase(std::unique(grown_from.begin(), grown_from.end()), grown_from.end());
  parallel_for_index(grown_from.size(), 4,
                     [&](std::size_t k) { orders[grown_from[k]] = growth_order(source, grown_from[k], options); });
  std::vector<GrownOverlap> out(seeds.size());
  parallel_for_index(seeds.size(), 4, [&](std::size_t k) {
    out[k] = grow_in_order(source, target, seeds[k], orders[seeds[k].source_region], options);
  });
  return out;
}

}  // namespace isthmus
