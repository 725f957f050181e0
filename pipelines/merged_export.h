// All scans of a component in one cloud, streamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/error.h"
#include "pipelines/e57_export.h"

namespace isthmus::pipelines {

struct SourcedScan {
  PlacedScan placed;
  std::uint16_t source = 0;  ///< its number in the cloud, from 1
};

/// Writes .las, .ply or .pcd (io/cloud_writer.h). With `voxel_m`, the first point of each voxel is kept, scans in the
/// given order: memory grows with the occupied voxels, 16 to 32 bytes each; without, it does not grow at all. Intensity
/// and colour are written if one scan has them; scans without get 0. Into LAS, intensities of scans that stay within 0
/// to 1 are spread over 0 to 65535. Returns the number of points.
Result<std::uint64_t> export_merged(const std::filesystem::path& path, const std::vector<SourcedScan>& scans,
                                    std::optional<double> voxel_m);

}  // namespace isthmus::pipelines
