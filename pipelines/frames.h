// Between the local frames in which stages compute and the scan frames of the files (io/scan_reader.h):
// p_in_scan = p_in_local + local_origin_in_scan.
#pragma once

#include "geometry/transform.h"

namespace isthmus::pipelines {

/// target_from_source between scan frames, from the same between local frames and the local origins in their scans.
Transform between_scan_frames(const Transform& target_from_source_local, const Eigen::Vector3d& source_origin,
                              const Eigen::Vector3d& target_origin);
/// The other way.
Transform between_local_frames(const Transform& target_from_source_scan, const Eigen::Vector3d& source_origin,
                               const Eigen::Vector3d& target_origin);

/// Information of the right perturbation (translation first) moved from the source's local frame to its scan frame.
Matrix6d information_in_scan_frame(const Matrix6d& information_local, const Eigen::Vector3d& source_origin);

}  // namespace isthmus::pipelines
