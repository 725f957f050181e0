// Ground-truth overlaps of scans at their true poses.
#pragma once

#include <filesystem>

#include "base/error.h"
#include "evaluate/inputs.h"
#include "evaluate/scan_points.h"

namespace isthmus::evaluate {

/// Voxel-sampled points with normals turned to the station, in the common frame.
struct Surface {
  Points points;
  Points normals;
};
Surface surface_of(const Points& points_in_scan, const Transform& common_from_scan, double voxel_m);

/// Share of a's points with a point of b among its four nearest that is within 1.5 voxels and faces the same way.
double covered_share(const Surface& a, const Surface& b, double voxel_m);

/// The smaller share of both directions for every pair of the truth, names sorted.
Result<Overlaps> compute_overlaps(const std::filesystem::path& scans_dir, const Poses& truth, double voxel_m);

}  // namespace isthmus::evaluate
