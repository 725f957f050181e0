// The points of a scan as the evaluation's definitions need them.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace isthmus::evaluate {

using Points = std::vector<Eigen::Vector3d>;

/// All finite points of a scan in the file's own coordinates. `name` may end in "#k" for the k-th scan of a file.
Result<Points> load_points(const std::filesystem::path& folder, const std::string& name);

/// The first point of every occupied voxel, in the order of the voxels' keys.
Points voxel_sampled(const Points& points, double voxel_m);

/// Mean of the scan sampled at a 200th of its extent: where translation errors of links are measured.
Eigen::Vector3d sampled_centroid(const Points& points);

}  // namespace isthmus::evaluate
