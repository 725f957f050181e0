// Between the local frames in which stages compute and the scan frames of the files (io/scan_reader.h):
// p_in_scan = p_in_local + local_origin_in_scan.
#pragma once

#include "geometry/transform.h"

namespace isthmus::pipelines {

/// target_from_source between scan frames, from the same between local frames and the local origins in their scans.
Transform between_scan_frames(const Transform& target_from_source_local, const Eigen::Vector3d& source_origin,
                              const Eigen::Vector3d& target_origin);

}  // namespace isthmus::pipelines
