// Poses of a finished survey for other programs; conventions in docs/outputs.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/finished_survey.h"

namespace isthmus::report {

enum class PoseFormat : std::uint8_t { open3d, tum, kitti, csv, dtk, riscan };

/// By name: "open3d", "tum", "kitti", "csv", "3dtk", "riscan".
std::optional<PoseFormat> pose_format(std::string_view name);

/// Whether the format has files for each scan instead of one file.
bool has_file_per_scan(PoseFormat format);

struct PoseFile {
  std::string name;  ///< relative
  std::string text;
};

/// 3dtk: scanNNN.pose and scanNNN.frames, counted in the order of the ids, and names.csv that says which is which;
/// riscan: the 4x4 matrix of each scan as NAME.DAT. Empty for the other formats.
std::vector<PoseFile> export_pose_files(const FinishedSurvey& survey, int component, PoseFormat format);

/// The others. One component (the formats know no second frame), scans in the order of their ids:
/// open3d: PoseGraph JSON with the accepted links; tum: "id x y z qx qy qz qw"; kitti: 3x4 row by row, without names;
/// csv: name and the 4x4 matrix row by row.
std::string export_poses(const FinishedSurvey& survey, int component, PoseFormat format);

}  // namespace isthmus::report
