#include "regions/seeds.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace isthmus {
namespace {

std::vector<std::vector<std::uint32_t>> samples_around_regions(const ScanModel& model,
                                                               const SeedScoreOptions& options) {
  const auto& regions = model.regions.regions;
  std::vector<std::vector<std::uint32_t>> samples(regions.size());
  const float sq_radius = options.radius_voxels * options.radius_voxels * model.voxel_m * model.voxel_m;
  parallel_for_index(regions.size(), 4, [&](std::size_t r) {
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < model.points.size(); ++i)
      if ((model.points[i] - regions[r].centre).squaredNorm() < sq_radius) near.push_back(i);
    const std::size_t n = std::min(options.max_points, near.size());
    for (std::size_t k = 0; k < n; ++k) samples[r].push_back(near[k * near.size() / n]);
  });
  return samples;
}

}  // namespace

void score_seeds(const ScanModel& source, const ScanModel& target, const SeedScoreOptions& options,
                 std::span<Seed> seeds) {
  const auto samples = samples_around_regions(source, options);
  std::vector<PointVerdicts> verdicts(seeds.size());
  parallel_for_index(seeds.size(), 32, [&](std::size_t k) {
    verdicts[k] =
        judge_points(source, target, seeds[k].target_from_source(source), samples[seeds[k].source_region], true);
  });
  // What most placements of a region explain tells little: a point weighs by how few of the region's seeds support it.
  std::vector<std::vector<float>> weight(samples.size());
  std::vector<float> seeds_of_region(samples.size(), 0);
  for (std::size_t r = 0; r < samples.size(); ++r) weight[r].assign(samples[r].size(), 0.0f);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    ++seeds_of_region[seeds[k].source_region];
    for (std::size_t i = 0; i < verdicts[k].size(); ++i)
      weight[seeds[k].source_region][i] += verdicts[k][i] == PointVerdict::supported;
  }
  for (std::size_t r = 0; r < samples.size(); ++r)
    for (float& w : weight[r]) w = std::log((seeds_of_region[r] + 1) / (w + 1)) / std::log(seeds_of_region[r] + 2);
  parallel_for_index(seeds.size(), 32, [&](std::size_t k) {
    float support = 0, contradiction = 0;
    for (std::size_t i = 0; i < verdicts[k].size(); ++i) {
      if (verdicts[k][i] == PointVerdict::supported) support += weight[seeds[k].source_region][i];
      contradiction += verdicts[k][i] == PointVerdict::contradicted;
    }
    const auto n = static_cast<float>(std::max<std::size_t>(1, verdicts[k].size()));
    seeds[k].score = (support - options.contradiction_weight * contradiction) / n;
  });
}

std::vector<Seed> seeds_at_poses(const ScanModel& source, const ScanModel& target, std::span<const Pose3f> poses) {
  constexpr std::size_t kLookPoints = 600;
  constexpr float kReachVoxels = 30;
  const auto stride = static_cast<std::uint32_t>(std::max<std::size_t>(1, source.points.size() / kLookPoints));
  std::vector<std::uint32_t> sample;
  for (std::uint32_t i = 0; i < source.points.size(); i += stride) sample.push_back(i);
  const auto& regions = source.regions.regions;
  std::vector<Seed> seeds(poses.size());
  parallel_for_index(poses.size(), 4, [&](std::size_t s) {
    const PointVerdicts verdicts = judge_points(source, target, poses[s], sample, true);
    float best = -1;
    Seed& seed = seeds[s];
    for (std::uint32_t r = 0; r < regions.size(); ++r) {
      float here = 0;
      for (std::size_t i = 0; i < sample.size(); ++i)
        if (verdicts[i] == PointVerdict::supported)
          here += std::max(0.0f,
                           1 - (source.points[sample[i]] - regions[r].centre).norm() / (kReachVoxels * source.voxel_m));
      if (here > best) best = here, seed.source_region = r;
    }
    seed.rotation = poses[s].rotation;
    seed.centre_in_target = poses[s] * regions[seed.source_region].centre;
  });
  return seeds;
}

std::vector<Seed> best_distinct_seeds(const ScanModel& source, std::vector<Seed> seeds, float position_m,
                                      float angle_rad, std::size_t keep) {
  std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.score > b.score; });
  const float min_trace = 1 + 2 * std::cos(angle_rad);
  std::vector<Seed> kept;
  for (const Seed& seed : seeds) {
    const Eigen::Vector3f place = seed.target_from_source(source) * source.regions.regions[seed.source_region].centre;
    bool known = false;
    for (Seed& other : kept) {
      const Eigen::Vector3f there =
          other.target_from_source(source) * source.regions.regions[seed.source_region].centre;
      if ((place - there).squaredNorm() > position_m * position_m) continue;
      if ((other.rotation.transpose() * seed.rotation).trace() < min_trace) continue;
      other.votes += seed.votes;
      known = true;
      break;
    }
    if (!known && kept.size() < keep) kept.push_back(seed);
  }
  return kept;
}

}  // namespace isthmus
