// From chunks of raw points to a SampledScan: streaming voxel sampling, normals, station, no-return shells.
#pragma once

#include <memory>
#include <span>

#include "base/error.h"
#include "config/option_table.h"
#include "scan/point_chunk.h"
#include "scan/sampled_scan.h"

namespace isthmus {

struct SamplingOptions {
  std::optional<double> voxel_m;  ///< absent: from the scans, see automatic_voxel_m()
  int target_points = 15000;      ///< voxel points a scan should be reduced to when the voxel is automatic
  bool drop_no_return = true;
  std::string station = "auto";  ///< auto, origin, unknown
  std::string stations;          ///< CSV file of stations in the scans' own coordinates; empty: none
};
const config::OptionTable<SamplingOptions>& sampling_options_table();

/// What a probe of one scan (io::probe_scan) says about its scale.
struct ScanScale {
  double voxel_m = 0;    ///< the voxel that would reduce this scan to the target number of points
  double spacing_m = 0;  ///< lower bound for the voxel: the probe's estimate of the raw spacing (0 = dense)
  double extent_m = 0;   ///< robust extent (5 % to 95 % box diagonal)
};
Result<ScanScale> scale_of_probe(const PointChunk& probe, std::optional<std::uint64_t> num_points, int target_points);

/// One voxel for all scans of a survey, from their scales in any order: a robust middle, rounded to a coarse geometric
/// series so that one more scan seldom changes it. Precondition: at least one scale.
double automatic_voxel_m(std::span<const ScanScale> scales);

/// Bounded memory whatever the number of raw points: one accumulator per occupied voxel.
class VoxelSampler {
 public:
  /// `header` gives frames and the station the file states; voxel_m > 0.
  VoxelSampler(const ScanHeader& header, double voxel_m, const SamplingOptions& options);
  ~VoxelSampler();
  void add(const PointChunk& chunk);
  /// Normals, station and notes. Fails if fewer than 10 voxels are occupied (empty or degenerate scan). Call once.
  Result<SampledScan> finish();
  [[nodiscard]] std::size_t bytes() const;  ///< memory held now

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isthmus
