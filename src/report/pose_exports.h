// Poses of a finished survey for other programs; conventions in docs/outputs.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "report/finished_survey.h"

namespace isthmus::report {

enum class PoseFormat : std::uint8_t { open3d, tum, kitti, csv };

/// By name: "open3d", "tum", "kitti", "csv".
std::optional<PoseFormat> pose_format(std::string_view name);

/// One component (the formats know no second frame), scans in the order of their ids:
/// open3d: PoseGraph JSON with the accepted links; tum: "id x y z qx qy qz qw"; kitti: 3x4 row by row, without names;
/// csv: name and the 4x4 matrix row by row.
std::string export_poses(const FinishedSurvey& survey, int component, PoseFormat format);

}  // namespace isthmus::report
