// Points to a SampledScan in one call, in chunks of any size.
#pragma once

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

inline SamplingSetup station_option(const std::string& word) {
  SamplingSetup setup;
  setup.options.station = word;
  return setup;
}

}  // namespace isthmus::testing
