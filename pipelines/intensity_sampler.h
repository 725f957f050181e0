// Intensities for the pictures of a scan, taken while its points stream by: no stage of the registration looks at them.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "scan/point_chunk.h"
#include "scan/sampled_scan.h"

namespace isthmus::pipelines {

/// Mean intensity by voxel of half the sampling's edge, of every third point: more costs time and shows no more.
class IntensitySampler {
 public:
  explicit IntensitySampler(double voxel_m) : cell_m_(voxel_m / 2) {}
  void add(const PointChunk& chunk);
  /// A value for each point of the scan's finest sampling, the mean of all where nothing was met; empty if a chunk came
  /// without intensities.
  [[nodiscard]] std::vector<float> of(const SampledScan& scan) const;

 private:
  struct Sum {
    double intensity = 0;
    std::uint32_t count = 0;
  };
  [[nodiscard]] std::uint64_t key_of(const Eigen::Vector3f& p) const;

  double cell_m_;
  bool complete_ = true;
  std::uint64_t next_ = 0;
  Sum all_;
  std::unordered_map<std::uint64_t, Sum> sums_;
};

}  // namespace isthmus::pipelines
