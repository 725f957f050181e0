// All scans of a component in one cloud, streamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/error.h"
#include "io/crs.h"
#include "pipelines/e57_export.h"

namespace isthmus::pipelines {

struct SourcedScan {
  PlacedScan placed;
  std::uint16_t source = 0;  ///< its number in the cloud, from 1
};

struct MergeOptions {
  std::optional<double> voxel_m;  ///< keep the first point of each voxel, scans in the given order
  std::optional<io::Crs> crs;     ///< of the poses' frame; LAS, LAZ and E57 have a place for it
};

/// Whether `path` ends in .las, .laz, .ply, .pcd or .e57.
bool knows_merged(const std::filesystem::path& path);

/// Writes one cloud in the poses' frame (io/cloud_writer.h), or an E57 file whose scans are the stations: points in the
/// scan's own frame, the pose in its header, for that is where programs look for the stations. With `voxel_m`, memory
/// grows with the occupied voxels, 16 to 32 bytes each; without, it does not grow at all. Intensity and colour are
/// written if one scan (E57: the scan) has them; scans without get 0. Into LAS and LAZ, intensities of scans that stay
/// within 0 to 1 are spread over 0 to 65535. Returns the number of points.
Result<std::uint64_t> export_merged(const std::filesystem::path& path, const std::vector<SourcedScan>& scans,
                                    const MergeOptions& options);

}  // namespace isthmus::pipelines
