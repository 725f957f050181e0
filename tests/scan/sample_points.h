// Points to a SampledScan in one call, in chunks of any size.
#pragma once

#include <Eigen/Geometry>
#include <stdexcept>

#include "pairwise/synthetic_scene.h"
#include "scan/sampling.h"

namespace isthmus::testing {

struct SamplingSetup {
  ScanHeader header;
  SamplingOptions options;
  std::size_t chunk = 65536;
};

inline Result<SampledScan> try_sampling(const Points& points, double voxel_m, const SamplingSetup& setup = {}) {
  VoxelSampler sampler(setup.header, voxel_m, setup.options);
  for (std::size_t i = 0; i < points.size(); i += setup.chunk)
    sampler.add(
        chunk_of(Points(points.begin() + static_cast<std::ptrdiff_t>(i),
                        points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), i + setup.chunk)))));
  return sampler.finish();
}

inline SampledScan sampled(const Points& points, double voxel_m, const SamplingSetup& setup = {}) {
  Result<SampledScan> scan = try_sampling(points, voxel_m, setup);
  if (!scan) throw std::runtime_error(scan.error().text());
  return *std::move(scan);
}

// So many points spread evenly over the box of the others that they are this share of all.
inline Points with_clutter(Points points, double share, std::uint64_t seed = 7) {
  Eigen::AlignedBox3f box;
  for (const auto& p : points) box.extend(p);
  Rng rng(seed);
  const auto added = static_cast<std::size_t>(share / (1 - share) * static_cast<double>(points.size()));
  for (std::size_t k = 0; k < added; ++k) {
    Eigen::Vector3f p;
    for (int a = 0; a < 3; ++a)
      p[a] = static_cast<float>(rng.uniform(static_cast<double>(box.min()[a]), static_cast<double>(box.max()[a])));
    points.push_back(p);
  }
  return points;
}

inline SamplingSetup station_option(const std::string& word) {
  SamplingSetup setup;
  setup.options.station = word;
  return setup;
}

}  // namespace isthmus::testing
